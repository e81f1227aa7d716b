"""Neighbours found cube by cube are those that a tree finds, however the points lie."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from baker.cubes import ENOUGH, MOST, Cubes

RNG = np.random.default_rng(3)
SHEET = RNG.random((3000, 3)) * [10.0, 10.0, 0.01]
CLOUDS = {
    "filled": RNG.random((3000, 3)),
    "sheet": SHEET,
    "thin and thick": np.concatenate([SHEET, 0.01 * SHEET, 20.0 * SHEET]),
    "far off": np.concatenate([SHEET, [[1e9, 0.0, 0.0], [-1e12, 1e12, 0.0], [1e12, 1e12, 1e12]]]),
    "in one place": np.concatenate([SHEET, np.full((MOST + 50, 3), 5.0)]),
    "all in one place": np.zeros((40, 3)),
    "two": np.eye(3)[:2],
}


def nearest(points, count):
    """(N, count) which points are the nearest to each, and how far, by the cloud's own numbers."""
    cubes = Cubes.of(points, count)
    found = [cubes.nearest(batch, count) for batch in cubes.batches()]
    near, apart = (np.concatenate(part) for part in zip(*found, strict=True))
    back = np.argsort(cubes.order)
    return cubes.order[near[back]], apart[back]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("name", CLOUDS)
def test_the_nearest_of_each_point_are_found(name, dtype):
    points = CLOUDS[name].astype(dtype)
    count = min(9, len(points))
    near, apart = nearest(points, count)
    np.testing.assert_array_equal(apart, cKDTree(points).query(points, np.arange(1, count + 1))[0])
    away = np.linalg.norm(points[near].astype(float) - points[:, None].astype(float), axis=2)
    np.testing.assert_allclose(away, apart, rtol=1e-12)
    assert (np.diff(np.sort(near, axis=1), axis=1) > 0).all()


@given(arrays(np.float32, st.tuples(st.integers(2, 40), st.just(3)), elements=st.integers(-4, 4)))
def test_the_nearest_on_a_grid_are_found(points):
    apart = nearest(points, 2)[1]
    np.testing.assert_array_equal(apart, cKDTree(points).query(points, [1, 2])[0])


@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.parametrize("reach", [0.02, 0.1, 0.3])
def test_pairs_are_all_that_is_within_reach_of_points_at_borders(reach, workers):
    points = np.random.default_rng(1).random((1500, 3)) * [3.0, 1.0, 0.1]
    points[: MOST + 50] = points[: MOST + 50] / 50.0 + [0.5, 0.0, 0.0]  # many around these
    owner = (2 * points[:, 0] + 0.01).astype(np.intp)
    cubes = Cubes.of(points, 9, reach)
    assert cubes.edge > reach
    one, other, apart = cubes.pairs(owner[cubes.order], reach, workers)
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


def test_points_of_one_owner_have_no_pairs():
    cubes = Cubes.of(SHEET, 9, 0.5)
    assert not len(cubes.pairs(np.zeros(len(SHEET), np.intp), 0.5)[0])
