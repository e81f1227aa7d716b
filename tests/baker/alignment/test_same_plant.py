"""Scans that no plant would give while it grows are named."""

import numpy as np
import pytest

from baker.alignment.same_plant import same_plant_findings
from baker.alignment.sample import even_sample


@pytest.fixture
def grown(plant) -> list[np.ndarray]:
    return [plant(day) for day in range(5)]


def doubt(clouds: list[np.ndarray]) -> str:
    """What is said about the scans of some points, which are in one frame."""
    samples = [even_sample(points, name=f"day{k}") for k, points in enumerate(clouds)]
    findings = same_plant_findings(samples, np.tile(np.eye(4), (len(clouds), 1, 1)))
    return "".join(finding.doubt for finding in findings)


def test_a_plant_that_grows_is_not_doubted(grown):
    assert doubt(grown) == ""


def test_copies_are_named(grown):
    assert "day3 may be a copy of the scan before" in doubt([*grown[:3], grown[2], grown[4]])


@pytest.mark.parametrize("scale", [0.8, 1.25])
def test_a_scan_of_another_scale_makes_the_plant_shrink(grown, scale):
    smaller = 2 if scale < 1 else 3
    said = doubt([*grown[:2], scale * grown[2], *grown[3:]])
    assert f"day{smaller} may be incomplete, or of another day or scale" in said


def test_days_that_run_backwards_are_doubted(grown):
    shrinking = [0.95**k * points for k, points in enumerate(grown[::-1])]
    assert "day1, day2, day3, day4 may be incomplete, or of another day" in doubt(shrinking)


def test_two_plants_side_by_side_are_doubted(grown):
    aside, above = np.array([[150.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    both = [np.append(points, points + aside, axis=0) for points in grown]
    assert "day0, day1, day2, day3, day4 may be several plants" in doubt(both)
    near = [np.append(points, points + above, axis=0) for points in grown]
    assert doubt(near) == ""
