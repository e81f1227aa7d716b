"""Hierarchies drawn as graphs."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from baker.report.graph import draw_tree, segment_centers, tree_layout
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy


def hierarchy_of(parents: list[int]) -> Hierarchy:
    """One point a segment; the first segment is the root."""
    segments = tuple(np.array([k]) for k in range(len(parents)))
    return Hierarchy(segments, (None,) * len(parents), tuple(parents), 0)


@st.composite
def trees(draw: st.DrawFn) -> Hierarchy:
    count = draw(st.integers(1, 60))
    return hierarchy_of([NO_PARENT, *(draw(st.integers(0, k - 1)) for k in range(1, count))])


@given(trees())
def test_children_stand_one_row_above_their_parent_and_around_it(tree):
    places = tree_layout(tree, range(len(tree.segments)))
    for segment, parent in enumerate(tree.parents):
        if parent != NO_PARENT:
            assert places[segment, 1] == places[parent, 1] + 1
        if own := tree.children(segment):
            columns = places[own, 0]
            assert places[segment, 0] == (columns.min() + columns.max()) / 2


@given(trees())
def test_nodes_keep_their_distance_inside_the_drawing(tree):
    graph = draw_tree(tree, range(len(tree.segments)))
    places = graph.places
    distances = np.linalg.norm(places[:, None] - places, axis=2) + 1e9 * np.eye(len(places))
    assert distances.min() > 2 * graph.radius
    assert (places >= graph.radius).all()
    assert (places <= np.array(graph.size) - graph.radius).all()
    assert len(places) == len(tree.segments)


def test_the_root_is_at_the_bottom_and_children_stand_by_organ():
    graph = draw_tree(hierarchy_of([NO_PARENT, 0, 0, 0]), [0, 3, 1, 2])
    x, y = graph.places.T
    assert y[0] == y.max() > y[1:].max()
    assert (1 + np.argsort(x[1:])).tolist() == [2, 3, 1]


def test_a_very_deep_tree_is_drawn():
    chain = hierarchy_of([NO_PARENT, *range(4999)])
    assert tree_layout(chain, [0] * 5000)[-1].tolist() == [0, 4999]


def test_a_segments_middle_is_one_of_its_points():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [4, 0, 0], [9, 9, 9]])
    virtual = Hierarchy(
        (np.arange(3), np.array([3]), np.empty(0, int)), (0, 1, None), (2, 2, -1), 2
    )
    assert segment_centers(virtual, points)[:2].tolist() == [[1, 0, 0], [9, 9, 9]]
