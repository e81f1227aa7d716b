"""The kNN graph is connected by its shortest gaps; geodesic distances are the shortest paths."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse.csgraph import connected_components, dijkstra, minimum_spanning_tree
from scipy.spatial.distance import cdist

from baker.geometry.graph import connected_knn_graph, geodesic_distances, knn_graph
from baker.geometry.neighbors import nearest_neighbors


def blobs(count: int, parts: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return rng.normal(size=(count, 3)) + 30 * rng.normal(size=(parts, 3))[np.arange(count) % parts]


@pytest.mark.parametrize("parts", [1, 2, 7])
@pytest.mark.parametrize("seed", range(3))
def test_components_are_joined_by_their_shortest_gaps(parts, seed):
    points = blobs(140, parts, seed)
    before = knn_graph(nearest_neighbors(points, 5))
    graph, bridges, widest = connected_knn_graph(points, 5)
    count, component = connected_components(before, directed=False)
    assert connected_components(graph, directed=False)[0] == 1
    assert bridges == count - 1
    between = cdist(points, points)
    gaps = [
        [between[np.ix_(component == a, component == b)].min() for a in range(count)]
        for b in range(count)
    ]
    added = (graph - before).tocoo()
    shortest = np.sort(minimum_spanning_tree(gaps).data)
    np.testing.assert_allclose(np.sort(added.data), shortest, rtol=1e-6)
    assert widest == pytest.approx(shortest.max(initial=0.0))


def test_distances_are_the_least_over_all_seeds_with_their_offsets():
    graph, _, _ = connected_knn_graph(blobs(200, 3, 0), 6)
    seeds, offsets = np.array([3, 60, 61]), np.array([0.0, 2.0, 0.5])
    each = dijkstra(graph, directed=False, indices=seeds)
    np.testing.assert_allclose(geodesic_distances(graph, seeds), each.min(axis=0))
    np.testing.assert_allclose(
        geodesic_distances(graph, seeds, offsets), (each + offsets[:, None]).min(axis=0), atol=1e-9
    )


@pytest.mark.parametrize("count", [1, 2, 30])
def test_points_in_one_place_are_no_distance_apart(count):
    graph, _, widest = connected_knn_graph(np.zeros((count, 3)), 3)
    assert geodesic_distances(graph, np.zeros(1, int), np.zeros(1)).max() < 1e-300
    assert widest == 0.0
