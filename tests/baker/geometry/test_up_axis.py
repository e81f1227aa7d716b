"""The direction of growth is one of the six axis directions."""

import numpy as np
import pytest

from baker.geometry.up_axis import Vertical


@pytest.mark.parametrize("name", ["x", "y", "z", "-x", "-y", "-z"])
def test_heights_are_the_z_coordinates_of_the_rotated_points(name):
    vertical, points = Vertical.named(name), np.random.default_rng(0).normal(size=(20, 3))
    np.testing.assert_array_equal((points @ vertical.to_z.T)[:, 2], vertical.height(points))
    np.testing.assert_array_equal(vertical.to_z @ vertical.to_z.T, np.eye(3))
    assert np.linalg.det(vertical.to_z) == pytest.approx(1.0), "a rotation, not a reflection"


def test_z_up_is_left():
    np.testing.assert_array_equal(Vertical.named("z").to_z, np.eye(3))
