"""Where organs are attached: the point nearest to what bears them, in either scan."""

import numpy as np
import pytest

from baker.interpolation.feet import Feet
from baker.matching import IntervalOrgans
from baker.matching.match import match_from_pairs
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy
from baker.transport.tasks import Task


def plant(count: int) -> tuple[np.ndarray, Hierarchy]:
    """An upright stem and a leaf of `count` points that leaves it at height 5, tip first."""
    stem = np.stack([np.zeros(50), np.zeros(50), np.linspace(0, 10, 50)], axis=1)
    along = np.linspace(4, 0.2, count)
    leaf = np.stack([along, np.zeros(count), 5 + along], axis=1)
    segments = np.arange(50), np.arange(50, 50 + count)
    return np.concatenate([stem, leaf]), Hierarchy(segments, (0, 1), (NO_PARENT, 0), 0)


@pytest.mark.parametrize(("before", "after"), [(30, 60), (200, 1000)])
def test_the_foot_is_the_point_nearest_to_the_bearer(before, after):
    (start, first), (end, second) = plant(before), plant(after)
    match = match_from_pairs(first, second, [(0, 0), (1, 1)])
    feet = Feet((start, end), match, IntervalOrgans({0: 7, 1: 3}, {0: 7, 1: 3}))
    leaf = Task("match", 3, first.segments[1], second.segments[1])
    foot = feet.of(leaf)
    assert (foot[0], foot[1]) == (before - 1, after - 1)
    # Counted within the task, of which a part may be missing.
    cut = Task("match", 3, first.segments[1][10:], second.segments[1])
    foot = feet.of(cut)
    assert (foot[0], foot[1]) == (before - 11, after - 1)


def test_neither_roots_nor_births_have_one():
    (start, first), (end, second) = plant(30), plant(40)
    match = match_from_pairs(first, second, [(0, 0), (1, 1)])
    feet = Feet((start, end), match, IntervalOrgans({0: 0, 1: 1}, {0: 0, 1: 1}))
    assert feet.of(Task("match", 0, first.segments[0], second.segments[0])) is None
    assert feet.of(Task("birth", 5, first.segments[0][:10], second.segments[1])) is None


def test_under_an_empty_root_there_is_none():
    points, hierarchy = plant(30)
    empty = Hierarchy((np.empty(0, int), np.arange(80)), (None, 1), (NO_PARENT, 0), 0)
    match = match_from_pairs(empty, empty, [(0, 0), (1, 1)])
    feet = Feet((points, points), match, IntervalOrgans({0: 0, 1: 1}, {0: 0, 1: 1}))
    assert feet.of(Task("match", 1, np.arange(80), np.arange(80))) is None
    assert len(hierarchy.segments) == 2
