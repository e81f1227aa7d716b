"""Segmentation along the spanning tree (section 3.2.2): bifurcations are found, nothing is lost."""

import numpy as np
import pytest
from scipy.sparse.csgraph import breadth_first_order, minimum_spanning_tree

from baker.geometry.graph import connected_knn_graph
from baker.geometry.neighbors import nearest_neighbors
from baker.segmentation.from_spanning_tree import hierarchy_from_spanning_tree, longest_paths
from baker.segmentation.hierarchy import NO_PARENT


def rod(start, end, count):
    return np.linspace(start, end, count)


STEM = rod([0, 0, 0], [0, 0, 10], 200)
LEFT = rod([0.05, 0, 6], [4, 0, 9], 100)
RIGHT = rod([-0.05, 0, 3], [-4, 0, 5], 80)


def longest_from(points, root, k=15):
    """The longest path from each point, and its parent."""
    tree = minimum_spanning_tree(connected_knn_graph(points, k))
    order, parent = breadth_first_order(tree, root, directed=False)
    return longest_paths(order, parent), parent


@pytest.mark.parametrize("blobs", [2, 3, 9])
def test_parts_are_joined_and_their_number_is_noted(blobs):
    line = np.array([[0, 0, 0.01 * i] for i in range(50)])
    points = np.concatenate([line + np.array([5.0 * b, 0, 0.1 * b]) for b in range(blobs)])
    hierarchy = hierarchy_from_spanning_tree(points, root=0)
    assert hierarchy.notes == (f"{blobs - 1} gaps in the cloud bridged where they are narrowest",)


def test_longest_paths_count_edges():
    longest, parent = longest_from(np.concatenate([STEM, LEFT]), 0)
    assert longest[199] == 0
    assert longest[0] == 219  # 119 edges up the stem, 100 along the branch
    assert all(longest[parent[1:]] > longest[1:])


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
    assert longest_from(points, 0, k=2)[0][0] == 19_999
    hierarchy = hierarchy_from_spanning_tree(points, 0, k=2)
    assert len(hierarchy.segments) == 1


@pytest.mark.parametrize("known", [5, 8, 16])
def test_neighbors_that_are_known_change_nothing(known):
    points = np.random.default_rng(0).random((300, 3))
    neighbors = nearest_neighbors(points, known)
    with_them = hierarchy_from_spanning_tree(points, 0, neighbors, 8, 5)
    assert with_them.parents == hierarchy_from_spanning_tree(points, 0, k=8, threshold=5).parents
