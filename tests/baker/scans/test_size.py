"""The numbers and the extents of points, and what is doubtful about them."""

from pathlib import Path

import numpy as np
import pytest

from baker.scans.scan import Scan
from baker.scans.size import points_finding, require_one_unit


def scan(points: np.ndarray, name: str) -> Scan:
    return Scan(points, path=Path(name), name=name)


@pytest.fixture
def cloud() -> np.ndarray:
    return np.random.default_rng(0).random((1000, 3))


def test_the_numbers_of_points_are_told(cloud: np.ndarray) -> None:
    finding = points_finding([scan(cloud, "day1"), scan(cloud[:200], "day2")])
    assert (finding.found, finding.doubt) == ("2 scans of 200 to 1,000", "")
    assert points_finding([scan(cloud, "day1")] * 3).found == "3 scans of 1,000"


def test_a_scan_of_few_points_is_doubted(cloud: np.ndarray) -> None:
    finding = points_finding([scan(cloud, "day1"), scan(cloud[:2], "day2")])
    assert finding.doubt == "'day2' has only 2"


def test_points_far_from_the_plant_are_doubted(cloud: np.ndarray) -> None:
    far = np.append(cloud, [[0.0, 0.0, 90.0]], axis=0)
    finding = points_finding([scan(cloud, "day1"), scan(far, "day2")])
    assert "some of 'day2' are far from the rest, all are 90 across" in finding.remark
    assert finding.option == "--outliers 2"


def test_the_factor_of_a_unit_fits_both_neighbours(cloud: np.ndarray) -> None:
    """A plant that grows between the scans: inches would be nearer to the one before."""
    sizes = {"day1": 18.5, "day2": 300.0, "day3": 44.0}
    finding = require_one_unit([scan(size * cloud, name) for name, size in sizes.items()], "")
    assert "multiply the coordinates of 'day2' by 0.1," in finding.remark
