"""Directions are turned onto others by the smallest angle."""

import numpy as np
from scipy.spatial.transform import Rotation

from baker.geometry.rigid import rotations_between


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
