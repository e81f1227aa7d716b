"""The nearest neighbours of every point: those that a search of all pairs finds."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.distance import cdist

from baker.nearby import along_curve
from baker.neighbours import neighbours


@pytest.mark.parametrize("ordered", [True, False])
@given(
    n=st.integers(1, 200),
    count=st.integers(1, 12),
    shape=st.sampled_from([(1, 1, 1), (9, 1, 0), (0, 0, 1), (0, 0, 0)]),
    seed=st.integers(0, 100),
)
def test_the_nearest_of_all_others(ordered, n, count, shape, seed):
    points = np.random.default_rng(seed).normal(size=(n, 3)).round(1) * shape
    points = points[along_curve(points)] if ordered else points
    away, near = neighbours(points, count)
    apart = cdist(points, points, "sqeuclidean")
    np.fill_diagonal(apart, np.inf)
    found = min(count, n - 1)
    np.testing.assert_allclose(away[:, :found], np.sort(apart)[:, :found])
    np.testing.assert_allclose(apart[np.arange(n)[:, None], near][:, :found], away[:, :found])
    assert all(len(set(row)) == found for row in near[:, :found])
    assert (near[:, found:] == np.arange(n)[:, None]).all()
    assert np.isinf(away[:, found:]).all()


def test_equal_points_are_neighbours_of_each_other():
    away, near = neighbours(np.zeros((30, 3)), 4)
    assert not away.any()
    assert (near != np.arange(30)[:, None]).all()
