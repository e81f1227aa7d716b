"""Which segments touch: all that come within three spacings of each other, and only they."""

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from baker.geometry.adjacency import MAX_GAP, segment_adjacency
from baker.geometry.neighbors import nearest_neighbors


def blocks(gap, count=4000):
    """A sheet of points cut into four strips, labelled 10 to 13, with gaps between them."""
    rng = np.random.default_rng(0)
    strip = rng.integers(0, 4, count)
    points = np.c_[rng.random((count, 2)), np.zeros(count)]
    points[:, 0] += strip * (1 + gap)
    return points, strip + 10


@pytest.mark.parametrize("gap", [0.0, 0.01])
def test_touching_segments_are_all_found_and_only_they(gap):
    points, labels = blocks(gap)
    neighbors = nearest_neighbors(points)
    gaps = segment_adjacency(labels, neighbors)
    between = cdist(points, points)
    for a in range(10, 14):
        for b in range(10, 14):
            least = between[np.ix_(labels == a, labels == b)].min()
            near = a != b and least < MAX_GAP * neighbors.spacing
            assert gaps.get((a, b)) == (pytest.approx(least, rel=1e-6) if near else None)
    assert len(gaps) == 6


def test_segments_farther_apart_do_not_touch():
    points, labels = blocks(0.1)
    assert segment_adjacency(labels, nearest_neighbors(points)) == {}


def test_labels_may_be_any_integers():
    points, labels = blocks(0.0)
    odd = np.array([-7, 10**12, 3, 0])[labels - 10]
    gaps = segment_adjacency(odd, nearest_neighbors(points))
    assert {pair for pair in gaps if pair[0] < pair[1]} == {(-7, 10**12), (3, 10**12), (0, 3)}


@pytest.mark.parametrize("count", [1, 50])
def test_one_segment_touches_nothing(count):
    points = np.random.default_rng(1).random((count, 3))
    assert segment_adjacency(np.ones(count, int), nearest_neighbors(points)) == {}
