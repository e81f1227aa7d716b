"""Point spacing is the distance to the nearest neighbour."""

import numpy as np
import pytest

from baker.geometry.spacing import lowest_point, point_spacing, without_outliers


@pytest.mark.parametrize("count", [2, 100, 50_000])
def test_spacing_of_points_on_a_line(count):
    points = np.zeros((count, 3))
    points[:, 1] = 0.25 * np.arange(count)
    assert point_spacing(points) == pytest.approx(0.25)


def test_degenerate_clouds_have_no_spacing():
    assert point_spacing(np.zeros((1, 3))) == 0.0
    assert point_spacing(np.zeros((0, 3))) == 0.0


def test_the_lowest_point_is_not_alone():
    cloud = np.random.default_rng(0).random((3000, 3))
    below = np.array([[0.5, 0.5, -50.0 - i] for i in range(5)])
    points = np.vstack([below, cloud])
    lowest = lowest_point(points, points[:, 2])
    assert lowest == 5 + np.argmin(cloud[:, 2])


def test_the_lowest_of_lonely_points_is_still_one():
    assert lowest_point(np.eye(3), np.array([3.0, 1.0, 2.0])) == 1
    assert lowest_point(np.zeros((1, 3)), np.zeros(1)) == 0


def test_lonely_points_are_outliers():
    cloud = np.random.default_rng(0).random((300, 3))
    mask = without_outliers(np.vstack([cloud, [[50.0, 0, 0]]]))
    assert not mask[-1]
    assert mask[:-1].all()
