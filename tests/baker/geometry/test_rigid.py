"""Rigid motions are recovered exactly; directions are turned onto others by the smallest angle."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from baker.geometry.rigid import fit_rigid, rotations_between


def test_a_rigid_motion_is_recovered():
    source = np.random.default_rng(0).normal(size=(40, 3))
    turn = Rotation.from_euler("xyz", [10, 20, 170], degrees=True).as_matrix()
    fit = fit_rigid(source, source @ turn.T + [1.0, 2.0, 3.0])
    np.testing.assert_allclose(fit[:3, :3], turn, atol=1e-12)
    np.testing.assert_allclose(fit[:3, 3], [1.0, 2.0, 3.0])


def test_a_mirror_image_is_not_fitted_by_a_reflection():
    source = np.random.default_rng(0).normal(size=(40, 3))
    fit = fit_rigid(source, source * [1, 1, -1])
    assert np.linalg.det(fit[:3, :3]) == pytest.approx(1.0)


@pytest.mark.parametrize("count", [1, 2, 9])
def test_points_on_a_line_are_only_moved(count):
    source = np.outer(np.arange(count), [1.0, 2.0, 0.0])
    fit = fit_rigid(source, source[:, [1, 2, 0]] + 1.0)
    np.testing.assert_array_equal(fit[:3, :3], np.eye(3))


def test_directions_are_turned_onto_others_by_the_angle_between_them():
    first, second = np.random.default_rng(0).normal(size=(2, 50, 3))
    first, second = (x / np.linalg.norm(x, axis=1, keepdims=True) for x in (first, second))
    turns = rotations_between(first, second)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", turns, first), second, atol=1e-12)
    angles = np.arccos((first * second).sum(axis=1))
    np.testing.assert_allclose(Rotation.from_matrix(turns).magnitude(), angles)


def test_opposite_and_equal_directions_are_left():
    up = np.array([[0.0, 0.0, 1.0]])
    for target in (up, -up):
        np.testing.assert_allclose(rotations_between(up, target), [np.eye(3)], atol=1e-12)
