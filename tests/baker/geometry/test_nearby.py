"""Nearest neighbours, whatever the order that the points come in."""

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from baker.geometry.halves import Halves
from baker.geometry.nearby import along_curve, bound_by, nearest, nearest_others

random = np.random.default_rng(3)


@pytest.mark.parametrize(("n", "m"), [(300, 200), (1, 40), (40, 1)])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_each_point_gets_its_nearest(n, m, dtype):
    points, among = (random.normal(size=(count, 3)).astype(dtype) for count in (n, m))
    np.testing.assert_array_equal(nearest(points, among), cdist(points, among).argmin(axis=1))


@pytest.mark.parametrize("along", [along_curve, lambda points: Halves.of(points).order])
def test_points_that_follow_one_another_are_near(along):
    points = random.random((2000, 3))
    order = along(points)
    np.testing.assert_array_equal(np.sort(order), np.arange(2000))
    steps = np.linalg.norm(np.diff(points[order], axis=0), axis=1)
    assert np.median(steps) < 0.25 * np.median(np.linalg.norm(np.diff(points, axis=0), axis=1))


@pytest.mark.parametrize("count", [1, 7, 400])
def test_the_nearest_points_are_within_what_a_sample_bounds(count):
    points, among = random.random((400, 3)), random.random((90, 3)) + np.array([0.5, 0, 0])
    bound = bound_by(points[::3], cKDTree(among), count)
    assert np.sort(cdist(points, among).min(axis=1))[: min(count, 134)].max() <= bound


def test_what_touches_is_not_bounded():
    assert bound_by(np.zeros((2, 3)), cKDTree(np.zeros((1, 3)))) == np.inf


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("n", [1, 2, 9, 300])
def test_others_are_found_in_any_order(n, dtype):
    points = random.normal(size=(n, 3)).astype(dtype)
    away, near = nearest_others(points, 3)
    apart = cdist(points, points)
    np.fill_diagonal(apart, np.inf)
    found = min(3, n - 1)
    np.testing.assert_array_equal(near[:, :found], np.argsort(apart, axis=1)[:, :found])
    np.testing.assert_allclose(away[:, :found], np.sort(apart, axis=1)[:, :found])
    assert (near[:, found:] == np.arange(n)[:, None]).all()
