"""The kNN graph is connected by its shortest gaps; geodesic distances are the shortest paths;
branches are what rises above the points where it meets something else."""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components, dijkstra, minimum_spanning_tree
from scipy.spatial.distance import cdist

from baker.geometry.graph import (
    best_path,
    branches,
    connected_knn_graph,
    geodesic_distances,
    knn_graph,
    segment_gaps,
)
from baker.geometry.neighbors import nearest_neighbors


def blobs(count: int, parts: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return rng.normal(size=(count, 3)) + 30 * rng.normal(size=(parts, 3))[np.arange(count) % parts]


@pytest.mark.parametrize("parts", [1, 2, 7])
@pytest.mark.parametrize("seed", range(3))
def test_components_are_joined_by_their_shortest_gaps(parts, seed):
    points = blobs(140, parts, seed)
    before = knn_graph(nearest_neighbors(points, 5))
    graph = connected_knn_graph(points, 5)
    count, component = connected_components(before, directed=False)
    assert connected_components(graph, directed=False)[0] == 1
    between = cdist(points, points)
    gaps = [
        [between[np.ix_(component == a, component == b)].min() for a in range(count)]
        for b in range(count)
    ]
    added = (graph - before).tocoo()
    shortest = np.sort(minimum_spanning_tree(gaps).data)
    np.testing.assert_allclose(np.sort(added.data), shortest, rtol=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_edges_of_a_mutual_graph_join_neighbours_of_each_other(seed):
    points = blobs(140, 2, seed)
    ranks = cdist(points, points).argsort(axis=1).argsort(axis=1)  # 0 for each point itself
    expected = (ranks <= 7) & (ranks.T <= 7) & ~np.eye(140, dtype=bool)
    edges = connected_knn_graph(points, 7, mutual=True).toarray() > 0.0
    assert edges[expected].all()
    count, component = connected_components(expected, directed=False)
    bridges = np.argwhere(edges & ~expected)
    assert (component[bridges[:, 0]] != component[bridges[:, 1]]).all()
    assert len(bridges) == count - 1
    assert connected_components(edges, directed=False)[0] == 1


def test_distances_are_the_least_over_all_seeds_with_their_offsets():
    graph = connected_knn_graph(blobs(200, 3, 0), 6)
    seeds, offsets = np.array([3, 60, 61]), np.array([0.0, 2.0, 0.5])
    each = dijkstra(graph, directed=False, indices=seeds)
    np.testing.assert_allclose(geodesic_distances(graph, seeds), each.min(axis=0))
    np.testing.assert_allclose(
        geodesic_distances(graph, seeds, offsets), (each + offsets[:, None]).min(axis=0), atol=1e-9
    )


@pytest.mark.parametrize("count", [1, 2, 30])
def test_points_in_one_place_are_no_distance_apart(count):
    graph = connected_knn_graph(np.zeros((count, 3)), 3)
    assert geodesic_distances(graph, np.zeros(1, int), np.zeros(1)).max() < 1e-300


def strips(gap, count=4000):
    """A sheet of points cut into four strips, labelled 10 to 13, with gaps between them."""
    rng = np.random.default_rng(0)
    strip = rng.integers(0, 4, count)
    points = np.c_[rng.random((count, 2)), np.zeros(count)]
    points[:, 0] += strip * (1 + gap)
    return points, strip + 10


@pytest.mark.parametrize("gap", [0.0, 0.01, 0.1, 7.0])
def test_gaps_are_the_least_distances_between_adjacent_segments_or_hardly_more(gap):
    points, labels = strips(gap)
    gaps, spacing = segment_gaps(points, labels), nearest_neighbors(points).spacing
    assert {pair for pair in gaps if pair[0] < pair[1]} == {(10, 11), (11, 12), (12, 13)}
    for (a, b), found in gaps.items():
        least = cdist(points[labels == a], points[labels == b]).min()
        assert 0.999999 < found * spacing / least < (1.1 if gap == 0.1 else 1.000001)
        assert gaps[b, a] == found


def test_labels_may_be_any_integers():
    points, labels = strips(0.0)
    gaps = segment_gaps(points, np.array([-7, 10**12, 3, 0])[labels - 10])
    assert {pair for pair in gaps if pair[0] < pair[1]} == {(-7, 10**12), (3, 10**12), (0, 3)}


@pytest.mark.parametrize("count", [1, 50])
def test_one_segment_touches_nothing(count):
    points = np.random.default_rng(1).random((count, 3))
    assert segment_gaps(points, np.ones(count, int)) == {}


def chain(count):
    before = np.arange(count - 1)
    return coo_matrix((np.ones(count - 1), (before, before + 1)), (count, count))


def found(heights, min_length, **limits):
    return branches(np.array(heights), chain(len(heights)), min_length, **limits).tolist()


def test_two_peaks_meet_at_their_pass():
    numbers = found([0.0, 3.0, 5.0, 2.0, 4.0, 1.0], 1.0)
    assert numbers[:3] + numbers[4:] == [-1, 0, 0, 1, -1]


def test_a_small_peak_is_part_of_the_greater():
    assert found([0.0, 3.0, 5.0, 3.5, 4.0, 1.0], 1.0) == [-1] * 6
    both = found([0.0, 3.0, 5.0, 3.5, 4.0, 1.0, 6.0], 1.0)
    assert both[1:5] == [1] * 4
    assert both[6] == 0


def test_a_third_peak_is_a_branch_of_its_own():
    numbers = np.array(found([0.0, 2.0, 1.0, 5.0, 3.0, 6.0, 0.5], 0.5))
    assert set(numbers[[1, 3, 5]]) == {0, 1, 2}
    assert (numbers[[0, 6]] == -1).all()


@pytest.mark.parametrize(("share", "count"), [(0.5, 2), (0.51, 0)])
def test_a_bump_is_short_against_what_it_is_on(share, count):
    assert max(found([3.0, 1.0, 2.0], 1.0, min_share=share)) == count - 1


@pytest.mark.parametrize(("points", "count"), [(2, 2), (4, 0)])
def test_a_bump_has_few_points(points, count):
    assert max(found([0.0, 5.0, 4.0, 1.0, 6.0, 5.5], 1.0, min_points=points)) == count - 1


def test_every_point_above_its_meeting_point_is_on_a_branch():
    rng = np.random.default_rng(0)
    heights = rng.random(300)
    numbers = np.array(found(heights, 0.0))
    peaks = np.flatnonzero((heights[1:-1] > heights[:-2]) & (heights[1:-1] > heights[2:])) + 1
    assert len(set(numbers[peaks])) == len(peaks)
    assert (numbers[peaks] >= 0).all()


@pytest.mark.parametrize("seed", range(8))
def test_the_best_path_has_the_largest_total_score(seed):
    rng = np.random.default_rng(seed)
    scores = [rng.random(shape) for shape in ((2, 3), (3, 2), (2, 4))]
    paths = product(range(2), range(3), range(2), range(4))
    total = {
        path: sum(s[i, j] for s, (i, j) in zip(scores, pairwise(path), strict=True))
        for path in paths
    }
    assert tuple(best_path(scores)) == max(total, key=total.__getitem__)


def test_of_equal_paths_the_first_is_the_best():
    assert best_path([np.ones((3, 2)), np.ones((2, 2))]) == [0, 0, 0]
    assert best_path([]) == [0]
