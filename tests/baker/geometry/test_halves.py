"""The nearest neighbours of every point are those that a library's tree finds, however they lie."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from baker.geometry.halves import ENOUGH, Halves
from baker.geometry.nearby import along_curve

RNG = np.random.default_rng(3)
SHEET = RNG.random((3000, 3)) * [10.0, 10.0, 0.01]
CLOUDS = {
    "filled": RNG.random((3000, 3)),
    "sheet": SHEET,
    "thin and thick": np.concatenate([SHEET, 0.01 * SHEET, 20.0 * SHEET]),
    "far off": np.concatenate([SHEET, [[1e9, 0.0, 0.0], [-1e12, 1e12, 0.0], [1e12, 1e12, 1e12]]]),
    "in one place": np.concatenate([SHEET, np.full((500, 3), 5.0)]),
    "all in one place": np.zeros((40, 3)),
    "two": np.eye(3)[:2],
    "one": np.ones((1, 3)),
}


def nearest(points, count):
    """(N, count) how far the nearest others are and which, by the cloud's own numbers."""
    halves = Halves.of(points)
    found = [halves.nearest(count, batch) for batch in halves.batches()]
    squared, near = (np.concatenate(part) for part in zip(*found, strict=True))
    back = np.argsort(halves.order)
    return np.sqrt(squared[back]), halves.order[near[back]]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("name", CLOUDS)
def test_the_nearest_of_each_point_are_found(name, dtype):
    points = CLOUDS[name].astype(dtype)
    apart, near = nearest(points, 8)
    there = min(8, len(points) - 1)
    if there:
        wanted = cKDTree(points).query(points, np.arange(2, there + 2))[0]
        np.testing.assert_array_equal(apart[:, :there], wanted)
    away = np.linalg.norm(points[near].astype(float) - points[:, None].astype(float), axis=2)
    np.testing.assert_allclose(away[:, :there], apart[:, :there], rtol=1e-12)
    own = np.arange(len(points))[:, None]
    assert (near[:, :there] != own).all()
    assert (np.diff(np.sort(near[:, :there], axis=1), axis=1) > 0).all()
    assert np.isinf(apart[:, there:]).all()
    assert (near[:, there:] == own).all()


@given(arrays(np.float32, st.tuples(st.integers(2, 40), st.just(3)), elements=st.integers(-4, 4)))
def test_the_nearest_on_a_grid_are_found(points):
    apart = nearest(points, 1)[0]
    np.testing.assert_array_equal(apart, cKDTree(points).query(points, [2])[0])


@pytest.mark.parametrize("ordered", [True, False])
@given(
    n=st.integers(1, 200),
    count=st.integers(1, 12),
    shape=st.sampled_from([(1, 1, 1), (9, 1, 0), (0, 0, 1), (0, 0, 0)]),
    seed=st.integers(0, 100),
)
def test_any_order_will_do(ordered, n, count, shape, seed):
    points = np.random.default_rng(seed).normal(size=(n, 3)).round(1) * shape
    points = points[along_curve(points)] if ordered else points
    squared, near = Halves.along(points).nearest(count)
    apart = cdist(points, points, "sqeuclidean")
    np.fill_diagonal(apart, np.inf)
    found = min(count, n - 1)
    np.testing.assert_allclose(squared[:, :found], np.sort(apart)[:, :found])
    np.testing.assert_allclose(apart[np.arange(n)[:, None], near][:, :found], squared[:, :found])


@pytest.mark.parametrize("count", [1, 2, 12, 13, 24, 25, 1000, 10_007])
def test_batches_are_all_points_once(count):
    halves = Halves.of(np.random.default_rng(count).random((count, 3)))
    np.testing.assert_array_equal(np.sort(halves.order), np.arange(count))
    places = [
        np.arange(halves.first[batch.start], halves.first[batch.stop]) for batch in halves.batches()
    ]
    np.testing.assert_array_equal(np.concatenate(places), np.arange(count))


@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.parametrize("reach", [0.02, 0.1, 0.3])
def test_pairs_are_all_that_is_within_reach_of_points_at_borders(reach, workers):
    points = np.random.default_rng(1).random((1500, 3)) * [3.0, 1.0, 0.1]
    points[:500] = points[:500] / 50.0 + [0.5, 0.0, 0.0]  # many around these
    owner = (2 * points[:, 0] + 0.01).astype(np.intp)
    halves = Halves.of(points)
    one, other, apart = halves.pairs(owner[halves.order], reach, workers)
    away = cdist(points, points)
    np.fill_diagonal(away, np.inf)
    foreign = np.where(owner[:, None] == owner, np.inf, away).min(axis=1)
    told = np.unique(one)
    assert np.isin(np.flatnonzero(foreign < reach), told).all()
    assert len(told) < len(points)
    for point in told:
        within = np.sort(away[point][away[point] < reach])[:ENOUGH]
        np.testing.assert_allclose(apart[one == point], within, rtol=1e-12)
    np.testing.assert_allclose(away[one, other], apart, rtol=1e-12)
    assert (np.diff(one) != 0).sum() == len(told) - 1  # all of a point follow one another


def test_points_in_one_place_are_within_no_reach_at_all():
    points = np.repeat(np.eye(3), 10, axis=0)
    halves = Halves.of(points)
    one, other, apart = halves.pairs(np.arange(30)[halves.order], 0.0)
    assert len(one) == 30 * 9
    assert not apart.any()
    np.testing.assert_array_equal(points[one], points[other])


def test_points_of_one_owner_have_no_pairs():
    assert not len(Halves.of(SHEET).pairs(np.zeros(len(SHEET), np.intp), 0.5)[0])
