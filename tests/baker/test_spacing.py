"""Point spacing is the distance to the nearest neighbour."""

import numpy as np
import pytest

from baker.spacing import point_spacing, without_outliers


@pytest.mark.parametrize("count", [2, 100, 50_000])
def test_spacing_of_points_on_a_line(count):
    points = np.zeros((count, 3))
    points[:, 1] = 0.25 * np.arange(count)
    assert point_spacing(points) == pytest.approx(0.25)


def test_degenerate_clouds_have_no_spacing():
    assert point_spacing(np.zeros((1, 3))) == 0.0
    assert point_spacing(np.zeros((0, 3))) == 0.0


def test_lonely_points_are_outliers():
    cloud = np.random.default_rng(0).random((300, 3))
    mask = without_outliers(np.vstack([cloud, [[50.0, 0, 0]]]))
    assert not mask[-1]
    assert mask[:-1].all()
