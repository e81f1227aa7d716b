"""Nearest neighbours along the longest axis: those that a search of all pairs finds."""

from __future__ import annotations

import numpy as np
import pytest

from baker.motion.nearest import gaps, nearest


@pytest.mark.parametrize("shape", [(1, 1, 1), (9, 1, 1), (1, 1, 30), (1, 9, 0)])
@pytest.mark.parametrize("count", [1, 2, 50])
@pytest.mark.parametrize("away", [0.0, 100.0])
def test_the_nearest_of_all(shape: tuple[int, ...], count: int, away: float) -> None:
    rng = np.random.default_rng(count)
    points = rng.normal(size=(count, 3)) * shape
    queries = rng.normal(size=(40, 3)) * shape + away
    apart = np.linalg.norm(queries[:, None] - points, axis=2)
    distance, found = nearest(queries, points)
    np.testing.assert_allclose(distance, apart.min(axis=1))
    np.testing.assert_allclose(apart[np.arange(40), found], apart.min(axis=1))


def test_gaps_are_means_both_ways() -> None:
    rng = np.random.default_rng(0)
    clouds, end = rng.normal(size=(3, 20, 3)), rng.normal(size=(30, 3))
    apart = np.linalg.norm(clouds[:, :, None] - end, axis=3)
    expected = apart.min(axis=2).mean(axis=1) + apart[:, :, ::3].min(axis=1).mean(axis=1)
    np.testing.assert_allclose(gaps(clouds, end, end[::3].copy()), expected)
