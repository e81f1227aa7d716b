"""Directions are turned onto others by the smallest angle; points by least squares."""

import numpy as np
from scipy.spatial.transform import Rotation

from baker.geometry.rigid import fit_rotation, rotations_between


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


def test_points_are_rotated_back():
    points = np.random.default_rng(0).normal(size=(6, 3))
    turn = Rotation.from_rotvec([0.4, -1.2, 0.7]).as_matrix()
    np.testing.assert_allclose(fit_rotation(points, points @ turn.T), turn, atol=1e-12)


def test_points_near_a_line_are_not_rotated_about_it():
    along = np.outer(np.linspace(-1, 1, 5), [0.0, 0.0, 1.0])
    noise = np.random.default_rng(1).normal(scale=0.02, size=(2, 5, 3))
    turn = fit_rotation(along + noise[0], along + noise[1], stiffness=0.01)
    assert Rotation.from_matrix(turn).magnitude() < 0.1
    loose = fit_rotation(along + noise[0], along + noise[1])
    assert Rotation.from_matrix(loose).magnitude() > 0.3
