"""Segmentation along the spanning tree (section 3.2.2): bifurcations are found, nothing is lost."""

import numpy as np
import pytest

from baker.geometry.graph import spanning_tree
from baker.geometry.neighbors import nearest_neighbors
from baker.segmentation.from_spanning_tree import hierarchy_from_spanning_tree, longest_paths
from baker.segmentation.hierarchy import NO_PARENT


def rod(start, end, count):
    return np.linspace(start, end, count)


STEM = rod([0, 0, 0], [0, 0, 10], 200)
LEFT = rod([0.05, 0, 6], [4, 0, 9], 100)
RIGHT = rod([-0.05, 0, 3], [-4, 0, 5], 80)


def test_the_tree_spans_the_cloud():
    points = np.random.default_rng(0).random((500, 3))
    tree = spanning_tree(points, root=7)
    assert tree.order[0] == 7
    assert tree.parent[7] == -1
    assert np.array_equal(np.sort(tree.order), np.arange(500))
    rank = np.argsort(tree.order)
    others = tree.order[1:]
    assert np.all(rank[tree.parent[others]] < rank[others])


def test_the_tree_is_the_shortest_one():
    from scipy.sparse.csgraph import minimum_spanning_tree
    from scipy.spatial.distance import pdist, squareform

    points = np.random.default_rng(1).random((120, 3))
    tree = spanning_tree(points, root=0, k=4)
    ours = np.linalg.norm(points[tree.order[1:]] - points[tree.parent[tree.order[1:]]], axis=1)
    assert ours.sum() == pytest.approx(minimum_spanning_tree(squareform(pdist(points))).sum())


@pytest.mark.parametrize("blobs", [2, 3, 9])
def test_parts_are_joined_by_their_shortest_gaps(blobs):
    line = np.array([[0, 0, 0.01 * i] for i in range(50)])
    points = np.concatenate([line + np.array([5.0 * b, 0, 0.1 * b]) for b in range(blobs)])
    tree = spanning_tree(points, root=0)
    assert tree.bridges == blobs - 1
    assert tree.widest == pytest.approx(5.0)


def test_longest_paths_count_edges():
    points = np.concatenate([STEM, LEFT])
    tree = spanning_tree(points, root=0)
    longest = longest_paths(tree)
    assert longest[199] == 0
    assert longest[0] == 219  # 119 edges up the stem, 100 along the branch
    for point in tree.order[1:]:
        assert longest[tree.parent[point]] >= longest[point] + 1


def test_bifurcations_are_found():
    points = np.concatenate([STEM, LEFT, RIGHT])
    hierarchy = hierarchy_from_spanning_tree(points, root=0, k=8)
    sizes = [len(segment) for segment in hierarchy.segments]
    # Two bifurcations cut the stem in three; each begins two segments (ruling 11).
    assert len(sizes) == 5
    assert sum(sizes) == len(points)
    assert hierarchy.parents.count(NO_PARENT) == 1
    owner = np.empty(len(points), int)
    for index, members in enumerate(hierarchy.segments):
        owner[members] = index
    assert len(set(owner[205:295])) == 1
    assert len(set(owner[305:375])) == 1
    assert owner[250] != owner[350] != owner[100] != owner[10]


def test_the_threshold_decides_what_is_a_branch():
    points = np.concatenate([STEM, rod([0.05, 0, 6], [0.6, 0, 6.3], 12)])
    assert len(hierarchy_from_spanning_tree(points, 0, k=8, threshold=5).segments) == 3
    assert len(hierarchy_from_spanning_tree(points, 0, k=8, threshold=30).segments) == 1


@pytest.mark.parametrize("count", [1, 2, 3])
def test_tiny_clouds_are_one_segment(count):
    points = np.arange(3.0 * count).reshape(count, 3)
    hierarchy = hierarchy_from_spanning_tree(points, 0)
    assert len(hierarchy.segments) == 1
    assert len(hierarchy.segments[0]) == count


def test_a_long_path_is_no_recursion():
    points = np.zeros((20_000, 3))
    points[:, 2] = np.arange(20_000)
    assert longest_paths(spanning_tree(points, 0, k=2))[0] == 19_999
    hierarchy = hierarchy_from_spanning_tree(points, 0, k=2)
    assert len(hierarchy.segments) == 1


@pytest.mark.parametrize("known", [5, 8, 16])
def test_neighbors_that_are_known_change_nothing(known):
    points = np.random.default_rng(0).random((300, 3))
    neighbors = nearest_neighbors(points, known)
    with_them = hierarchy_from_spanning_tree(points, 0, neighbors, 8, 5)
    assert with_them.parents == hierarchy_from_spanning_tree(points, 0, k=8, threshold=5).parents
