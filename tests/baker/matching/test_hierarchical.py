"""Matching down the hierarchies (section 3.3.1): merging, children, births, losses."""

import numpy as np
import pytest

from baker.matching.hierarchical import assign_by_minima, match_hierarchies
from baker.matching.match import Match, match_from_pairs, match_series
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy
from baker.transport.solve import wasserstein


def rms_distance(a, b):
    """A stand-in for d_w that is exact for clouds that are shifted copies of each other."""
    from scipy.spatial import cKDTree

    there, back = cKDTree(b).query(a)[0], cKDTree(a).query(b)[0]
    return float(np.sqrt((there**2).mean() + (back**2).mean()))


def rod(start, end):
    length = np.linalg.norm(np.subtract(end, start))
    return np.linspace(start, end, max(2, int(20 * length)))


def scan(parents, *rods):
    points = np.concatenate(rods)
    stops = np.cumsum([len(r) for r in rods])
    segments = tuple(np.arange(stop - len(r), stop) for r, stop in zip(rods, stops, strict=True))
    labels = (None,) * len(rods)
    return points, Hierarchy(segments, labels, tuple(parents), 0)


STEM = rod([0, 0, 0], [0, 0, 10])
LEFT, RIGHT = rod([0, 0, 5], [4, 0, 7]), rod([0, 0, 5], [-4, 0, 7])
LOWER_STEM, UPPER_STEM = rod([0, 0, 0], [0, 0, 5]), rod([0, 0, 5], [0, 0, 10])


def matched(first, second, distance=rms_distance) -> Match:
    (p, h), (q, g) = first, second
    return match_from_pairs(h, *match_hierarchies((p, q), (h, g), distance))


def test_children_meet_whatever_their_order():
    first = scan([NO_PARENT, 0, 0], STEM, LEFT, RIGHT)
    second = scan([NO_PARENT, 0, 0], STEM, RIGHT, LEFT)
    match = matched(first, second)
    assert sorted(match.pairs) == [(0, 0), (1, 2), (2, 1)]
    assert not match.births
    assert not match.losses


def test_a_stem_cut_at_a_new_fork_is_merged_again():
    first = scan([NO_PARENT], STEM)
    second = scan([NO_PARENT, 0, 0], LOWER_STEM, UPPER_STEM, LEFT)
    match = matched(first, second)
    assert len(match.second.segments) == 2
    stem = match.second.segments[match.pairs[0][1]]
    assert len(stem) == len(LOWER_STEM) + len(UPPER_STEM)
    assert [len(match.second.segments[b]) for b in match.births] == [len(LEFT)]


def test_nothing_merges_in_the_first_scan():
    first = scan([NO_PARENT, 0], LOWER_STEM, UPPER_STEM)
    second = scan([NO_PARENT], STEM)
    assert len(matched(first, second).losses) == 1


def test_a_subtree_is_born_and_lost_whole():
    twig = rod([2, 0, 6], [2, 3, 8])
    bare, full = scan([NO_PARENT], STEM), scan([NO_PARENT, 0, 1], STEM, LEFT, twig)
    born = matched(bare, full)
    assert [len(born.second.segments[b]) for b in born.births] == [len(LEFT), len(twig)]
    lost = matched(full, bare)
    assert [len(lost.first.segments[b]) for b in lost.losses] == [len(LEFT), len(twig)]


def test_a_very_deep_hierarchy_is_no_recursion():
    pieces = [rod([0, 0, z], [0, 0, z + 0.9]) for z in range(1500)]
    chain = scan([NO_PARENT, *range(1499)], *pieces)
    match = matched(chain, chain, lambda a, b: abs(len(a) - len(b)))
    assert len(match.pairs) == 1500


def test_assignment_by_minima_leaves_out_the_farthest():
    costs = np.array([[1.0, 9.0, 2.0], [8.0, 9.0, 1.0]])
    assert assign_by_minima(costs) == [(0, 0), (1, 2)]
    assert assign_by_minima(costs.T) == [(0, 0), (2, 1)]


def rosette(count, turn, seed):
    """Leaves all around a stem, numbered at random."""
    random = np.random.default_rng(seed)
    angles = turn + 2 * np.pi * random.permutation(count) / count
    leaves = [
        rod([0, 0, 5], [3 * np.cos(a), 3 * np.sin(a), 6 + a / 9]) + random.normal(0, 0.02, 3)
        for a in angles
    ]
    return scan([NO_PARENT] + [0] * count, STEM, *leaves)


def test_the_leaves_of_a_rosette_meet_the_nearest():
    first, second = rosette(12, 0.0, 1), rosette(10, 0.05, 2)
    match = matched(first, second, wasserstein)
    leaves = [(a, b) for a, b in match.pairs if (a, b) != (0, 0)]
    for a, b in leaves:
        before = first[0][match.first.segments[a]].mean(axis=0)
        after = second[0][match.second.segments[b]].mean(axis=0)
        assert np.linalg.norm(after - before) < 1.0
    assert len(leaves) >= 8


@pytest.mark.parametrize("by_label", [False, True])
def test_progress_goes_up_to_all_segments(by_label):
    scans = [rosette(count, 0.1 * count, count) for count in (4, 6, 5)]
    told = []
    match_series(
        [points for points, _ in scans],
        [hierarchy for _, hierarchy in scans],
        by_label=by_label,
        distance=rms_distance,
        report_progress=lambda done, total: told.append((done, total)),
    )
    assert (told[0], told[-1]) == ((0, 13), (13, 13))
    assert told == sorted(told)
    assert (7, 13) in told
