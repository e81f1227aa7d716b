"""A hierarchy on given labels (section 3.2.1): who grows from whom."""

import numpy as np
import pytest

from baker.geometry.graph import segment_gaps
from baker.segmentation.from_labels import hierarchy_from_labels
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy


def hierarchy_of(points, labels, root_label) -> Hierarchy:
    return hierarchy_from_labels(labels, root_label, segment_gaps(points, labels))


def rod(start, end, count=200):
    """Points along a line, evenly spaced."""
    return np.linspace(start, end, count)


def plant(*rods):
    points = np.concatenate(rods)
    labels = np.repeat(np.arange(len(rods)), [len(r) for r in rods])
    return points, labels


def parents_by_label(hierarchy: Hierarchy) -> dict:
    return {
        label: None if parent == NO_PARENT else hierarchy.labels[parent]
        for label, parent in zip(hierarchy.labels, hierarchy.parents, strict=True)
    }


STEM = rod([0, 0, 0], [0, 0, 10])
BRANCH = rod([0.05, 0, 5], [5, 0, 8], 120)
TWIG = rod([3, 0.05, 6.8], [3, 4, 9], 100)


def test_branches_hang_on_what_they_touch():
    points, labels = plant(STEM, BRANCH, TWIG)
    assert parents_by_label(hierarchy_of(points, labels, 0)) == {0: None, 1: 0, 2: 1}


def test_every_point_is_in_exactly_one_segment():
    points, labels = plant(STEM, BRANCH, TWIG)
    hierarchy = hierarchy_of(points, labels, 0)
    assert np.array_equal(np.sort(np.concatenate(hierarchy.segments)), np.arange(len(points)))


def test_labels_may_be_any_integers():
    points, labels = plant(STEM, BRANCH, TWIG)
    odd = np.array([-7, 10**12, 3])[labels]
    expected = {-7: None, 10**12: -7, 3: 10**12}
    assert parents_by_label(hierarchy_of(points, odd, -7)) == expected


def test_a_gap_is_bridged_and_said():
    floating = rod([2, 0, 6], [5, 0, 8], 120)
    points, labels = plant(STEM, floating, rod([0, 0.05, 3], [0, 4, 4]))
    hierarchy = hierarchy_of(points, labels, 0)
    assert parents_by_label(hierarchy)[1] == 0
    assert any("segment 1 touches no other one" in note for note in hierarchy.notes)


def test_the_nearest_gap_wins():
    between = rod([0.1, 0.0, 5], [3, 0, 5])
    other = rod([3.02, 0, 5], [6, 0, 5])
    points, labels = plant(STEM, between, other)
    assert parents_by_label(hierarchy_of(points, labels, 0)) == {0: None, 1: 0, 2: 1}


def test_a_rosette_hangs_under_a_virtual_root():
    leaves = [rod([np.cos(a), np.sin(a), 0], [5 * np.cos(a), 5 * np.sin(a), 2]) for a in range(4)]
    hierarchy = hierarchy_of(*plant(*leaves), 0)
    assert hierarchy.labels[hierarchy.root] is None
    assert len(hierarchy.segments[hierarchy.root]) == 0
    assert all(parent in (NO_PARENT, hierarchy.root) for parent in hierarchy.parents)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_tiny_clouds(count):
    points = np.zeros((count, 3))
    hierarchy = hierarchy_of(points, np.arange(count), 0)
    assert sorted(np.concatenate(hierarchy.segments).tolist()) == list(range(count))


def test_between_two_branches_the_nearer_one_bears_the_twig():
    one = rod([0.01, 0, 5], [4.01, 0, 5], 81)
    other = rod([0.02, 0.055, 5], [4.02, 0.055, 5], 81)
    twig = rod([2.015, 0.04, 5], [2.015, 0.04, 8], 61)  # 0.04 from the one, 0.015 from the other
    stem = rod([0, 0.0275, 0], [0, 0.0275, 10], 201)  # nearer to both than they to one another
    points, labels = plant(stem, one, other, twig)
    assert parents_by_label(hierarchy_of(points, labels, 0))[3] == 2
