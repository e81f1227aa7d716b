"""Organs grow by their course through the whole series."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from baker.interval import Moved
from baker.match import IntervalOrgans, Match
from baker.motion import Growth, grown, growths
from baker.motion.growth import half_way_sizes
from baker.segment.hierarchy import NO_PARENT, Hierarchy
from gclip.clip import Motion
from gclip.evaluate import bernstein
from gclip.pack import Movers

COUNT = 300


def sigmoid(times: np.ndarray) -> np.ndarray:
    return 100 / (1 + np.exp(-times))


def test_a_sigmoid_is_followed_closer_than_by_straight_lines() -> None:
    times = np.array([-4.0, -2.5, -1.0, 0.0, 1.5, 3.0, 5.0])
    sizes, middle = sigmoid(times), (times[1:] + times[:-1]) / 2
    straight = (sizes[1:] + sizes[:-1]) / 2
    ours = half_way_sizes(times, sizes) * straight
    assert np.abs(ours / sigmoid(middle) - 1).max() < 0.1
    wrong = np.abs(straight / sigmoid(middle) - 1)
    assert np.abs(ours / sigmoid(middle) - 1).mean() < 0.25 * wrong.mean()


def test_sizes_never_leave_what_they_are_at_the_scans() -> None:
    random = np.random.default_rng(0)
    for _ in range(50):
        times = np.cumsum(random.uniform(0.1, 5, 8))
        sizes = random.uniform(1, 100, 8)
        half = half_way_sizes(times, sizes) * (sizes[1:] + sizes[:-1]) / 2
        assert (half >= np.minimum(sizes[1:], sizes[:-1]) * (1 - 1e-9)).all()
        assert (half <= np.maximum(sizes[1:], sizes[:-1]) * (1 + 1e-9)).all()


def test_two_scans_tell_no_course() -> None:
    np.testing.assert_array_equal(half_way_sizes(np.array([0.0, 3.0]), np.array([1.0, 9.0])), [1.0])


def leafy(length: float) -> tuple[np.ndarray, Hierarchy]:
    """A stem, and a leaf of a length half-way up."""
    stem = np.column_stack([np.zeros((COUNT, 2)), np.linspace(0, 50, COUNT)])
    leaf = np.column_stack([np.linspace(0.5, length, COUNT), np.zeros(COUNT), np.full(COUNT, 25.0)])
    members = (np.arange(COUNT), np.arange(COUNT, 2 * COUNT))
    return np.concatenate([stem, leaf]), Hierarchy(members, (0, 1), (NO_PARENT, 0), 0)


def test_a_leaf_is_as_long_half_way_as_its_course_says() -> None:
    times = np.array([-3.0, -1.0, 1.0, 3.0])
    scans = [leafy(size) for size in sigmoid(times)]
    matches = [Match(one[1], two[1], ((0, 0), (1, 1)), (), ()) for one, two in pairwise(scans)]
    named = [IntervalOrgans({0: 0, 1: 1}, {0: 0, 1: 1}) for _ in matches]
    found = growths([points for points, _ in scans], matches, named, times)
    assert all(set(interval) == {1} for interval in found)
    for k, growth in enumerate(found):
        tasks = [
            Moved(
                Movers(
                    Motion.MOVE,
                    tuple(
                        scan[members].astype(np.float32) for scan in (scans[k][0], scans[k + 1][0])
                    ),
                    np.full(COUNT, organ),
                ),
                None,
                None,
                members,
                members,
            )
            for organ, members in enumerate(scans[0][1].segments)
        ]
        after = grown(tasks, matches[k], named[k], growth)
        assert after[0] is tasks[0]
        curve = after[1].movers.curve
        half = np.tensordot(bernstein(len(curve) - 1, 0.5), np.stack(curve), axes=1)
        truth = sigmoid((times[k] + times[k + 1]) / 2)
        straight = (sigmoid(times[k]) + sigmoid(times[k + 1])) / 2
        share = 1.0 if k == 2 else 0.5  # the last interval tells of no slowing down
        assert abs(half[:, 0].max() - truth) <= share * abs(straight - truth) + 1
        for u, scan in ((0.0, k), (1.0, k + 1)):
            ends = np.tensordot(bernstein(len(curve) - 1, u), np.stack(curve), axes=1)
            np.testing.assert_allclose(ends, scans[scan][0][COUNT:], atol=1e-4)


def test_what_grows_on_an_organ_is_carried_along() -> None:
    branch = np.column_stack([np.linspace(0, 40, COUNT), np.zeros((COUNT, 2))])
    twig = np.column_stack([np.full(COUNT, 40.0), np.linspace(0, 9, COUNT), np.zeros(COUNT)])
    members = tuple(np.arange(COUNT) + COUNT * k for k in range(3))
    hierarchy = Hierarchy(members, (0, 1, 2), (NO_PARENT, 0, 1), 0)
    match = Match(hierarchy, hierarchy, ((0, 0), (1, 1), (2, 2)), (), ())
    tasks = [
        Moved(Movers(Motion.MOVE, (points, points), np.full(COUNT, organ)), None, None, own, own)
        for organ, points, own in ((1, branch, members[1]), (2, twig, members[2]))
    ]
    growth = {1: Growth(0.8, np.zeros(3)), 2: Growth(1.0, np.array([40.0, 0, 0]))}
    names = {0: 0, 1: 1, 2: 2}
    after = grown(tasks, match, IntervalOrgans(names, names), growth)
    half = [m.movers.curve[0] / 4 + m.movers.curve[1] / 2 + m.movers.curve[2] / 4 for m in after]
    np.testing.assert_allclose(half[0], 0.8 * branch, atol=1e-4)
    np.testing.assert_allclose(half[1], twig - [8.0, 0, 0], atol=1e-4)
