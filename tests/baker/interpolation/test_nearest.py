"""Nearest neighbours along the longest axis: those that a search of all pairs finds."""

from __future__ import annotations

import numpy as np
import pytest

from baker.interpolation.nearest import line, line_along, nearest, nearest_cloud, nearest_on


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
    for beyond in (0.0, 0.1, np.inf):
        target = line(points)
        near, same = nearest_on(line_along(queries, target[0]), target, beyond)
        asked = distance <= distance.min() + beyond
        np.testing.assert_array_equal(near[asked], distance[asked])
        np.testing.assert_array_equal(same[asked], found[asked])
        assert (near >= distance).all()


@pytest.mark.parametrize("seed", range(4))
def test_the_nearest_cloud_by_means_both_ways(seed: int) -> None:
    rng = np.random.default_rng(seed)
    end, prices = rng.normal(size=(30, 3)), rng.uniform(1.0, 1.2, size=12)
    clouds = rng.normal(size=(12, 120, 3)) + rng.normal(size=(12, 1, 3)) / 2
    apart = np.linalg.norm(clouds[:, :, None] - end, axis=3)
    gaps = apart.min(axis=2).mean(axis=1) + apart[:, :, ::3].min(axis=1).mean(axis=1)
    assert nearest_cloud(clouds, end, end[::3].copy(), prices) == np.argmin(gaps * prices)
