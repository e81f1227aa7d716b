"""The nearest other points of a cloud are those that looking at all pairs finds."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from baker.nearby import nearest_others


def by_all_pairs(points):
    apart = ((points[:, None] - points[None]) ** 2).sum(axis=2)
    np.fill_diagonal(apart, np.inf)
    return np.sort(apart, axis=1)


@given(
    st.integers(2, 300), st.integers(0, 1000), st.sampled_from(["even", "line", "grid", "two far"])
)
def test_distances_are_those_of_all_pairs(count, seed, shape):
    random = np.random.default_rng(seed)
    points = random.normal(size=(count, 3))
    if shape == "line":
        points[:, 1:] = 0
    if shape == "grid":  # with duplicates
        points = np.round(2 * points)
    if shape == "two far":
        points[: count // 2] += 1e9
    ranks = np.unique(random.integers(0, count - 1, 4))
    squares, found = nearest_others(points, ranks)
    np.testing.assert_allclose(squares, by_all_pairs(points)[:, ranks], rtol=1e-12, atol=0)
    np.testing.assert_allclose(squares, ((points[:, None] - points[found]) ** 2).sum(axis=2))
    assert (found != np.arange(count)[:, None]).all()


@pytest.mark.parametrize("count", [2_000, 20_001])
def test_large_clouds_agree_with_another_tree(count):
    from scipy.spatial import cKDTree

    points = np.random.default_rng(1).random((count, 3)) ** 3
    squares, found = nearest_others(points, np.arange(7))
    distances, there = cKDTree(points).query(points, np.arange(2, 9))
    np.testing.assert_array_equal(np.sqrt(squares), distances)
    np.testing.assert_array_equal(found, there)
    for one, other in zip(
        (squares, found), nearest_others(points, np.arange(7), workers=3), strict=True
    ):
        np.testing.assert_array_equal(one, other)


def test_points_at_one_place_are_each_others_nearest():
    points = np.zeros((100, 3))
    squares, found = nearest_others(points, np.arange(8))
    assert (squares == 0).all()
    assert all(len(set(row)) == 8 for row in found.tolist())
