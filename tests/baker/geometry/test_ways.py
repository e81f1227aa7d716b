"""Shortest ways from neighbour to neighbour: those that scipy finds, gaps bridged."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components, dijkstra, minimum_spanning_tree
from scipy.spatial.distance import cdist

from baker.geometry.nearby import nearest_others
from baker.geometry.ways import links, ways

NONE = np.empty((0, 2), np.intp)


def cloud(count: int, parts: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return rng.normal(size=(count, 3)) + 30 * rng.normal(size=(parts, 3))[np.arange(count) % parts]


def matrix(points: np.ndarray, one: np.ndarray, other: np.ndarray) -> coo_matrix:
    lengths = np.linalg.norm(points[one] - points[other], axis=1)
    return coo_matrix((lengths, (one, other)), (len(points), len(points)))


@pytest.mark.parametrize("count", [1, 2, 5, 80])
@pytest.mark.parametrize("bridged", [False, True])
def test_every_link_is_at_both_of_its_ends_once(count, bridged):
    points = cloud(count, 1, count)
    near = nearest_others(points, 4)[1]
    bridges = np.array([[0, count - 1]]) if bridged and count == 80 else NONE
    first, ends, lengths = links(points, near, bridges)
    found = [ends[a:b] for a, b in pairwise(first)]
    wanted = [{int(other) for other in near[point]} - {point} for point in range(count)]
    for one, other in [(a, b) for a in range(count) for b in wanted[a]] + bridges.tolist():
        wanted[one].add(other)
        wanted[other].add(one)
    assert [list(other) for other in found] == [sorted(other) for other in wanted]
    way = points[np.repeat(np.arange(count), np.diff(first))] - points[ends]
    np.testing.assert_allclose(lengths, np.linalg.norm(way, axis=1))


@pytest.mark.parametrize("parts", [1, 2, 7])
@pytest.mark.parametrize("seed", range(3))
def test_ways_are_the_shortest_with_the_shortest_gaps_bridged(parts, seed):
    points = cloud(140, parts, seed)
    near = nearest_others(points, 5)[1]
    seeds, heads = np.array([3, 60]), np.array([0.0, 0.2])
    way, bridges = ways(points, links(points, near, NONE), seeds, heads)

    graph = matrix(points, np.repeat(np.arange(140), 5), near.ravel())
    count, part = connected_components(graph, directed=False)
    apart = cdist(points, points)
    gaps = [[apart[np.ix_(part == a, part == b)].min() for a in range(count)] for b in range(count)]
    lengths = np.linalg.norm(points[bridges[:, 0]] - points[bridges[:, 1]], axis=1)
    within = set(part[seeds].tolist())
    if len(within) == 1:
        np.testing.assert_allclose(np.sort(lengths), np.sort(minimum_spanning_tree(gaps).data))
    assert len(bridges) == count - len(within)
    both = dijkstra((graph + matrix(points, *bridges.T)).tocsr(), directed=False, indices=seeds)
    np.testing.assert_allclose(way, (both + heads[:, None]).min(axis=0))


def test_points_in_one_place_are_reached_at_once():
    points = np.zeros((30, 3))
    way, _ = ways(
        points, links(points, nearest_others(points, 3)[1], NONE), np.zeros(1, int), np.zeros(1)
    )
    assert not way.any()
