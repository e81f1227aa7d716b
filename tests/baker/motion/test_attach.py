"""Organs stay attached between the scans."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from baker.interval import Moved
from baker.match import IntervalOrgans, Match
from baker.motion import attached
from baker.segment.hierarchy import NO_PARENT, Hierarchy
from gclip.clip import Motion
from gclip.evaluate import bernstein
from gclip.pack import Movers

COUNT = 200


def at(moved: Moved, u: float) -> np.ndarray:
    curve = moved.movers.curve
    return np.tensordot(bernstein(len(curve) - 1, u), np.stack(curve), axes=1)


def tasks_of(leaf: tuple[np.ndarray, ...]) -> tuple[list[Moved], Match, IntervalOrgans]:
    """A stem that stands at x = 0, and a leaf on the given paths."""
    stem = np.column_stack([np.zeros((COUNT, 2)), np.linspace(0, 50, COUNT)])
    first, second = np.arange(COUNT), np.arange(COUNT, 2 * COUNT)
    hierarchy = Hierarchy((first, second), (0, 1), (NO_PARENT, 0), 0)
    moved = [
        Moved(
            Movers(Motion.MOVE, tuple(p.astype(np.float32) for p in curve), np.full(COUNT, organ)),
            None,
            None,
            members,
            members,
        )
        for organ, members, curve in ((0, first, (stem, stem)), (1, second, leaf))
    ]
    match = Match(hierarchy, hierarchy, ((0, 0), (1, 1)), (), ())
    return moved, match, IntervalOrgans({0: 0, 1: 1}, {0: 0, 1: 1})


def blade() -> np.ndarray:
    along = np.linspace(0.5, 40, COUNT)
    return np.column_stack([along, 0 * along, 25 + 0 * along])


def test_a_base_that_would_leave_its_stem_stays() -> None:
    leaf = (blade(), blade() + np.array([12.0, 0.0, 0.0]), blade())
    solved, match, organs = tasks_of(leaf)
    before = cKDTree(at(solved[0], 0.5)).query(at(solved[1], 0.5))[0].min()
    (after,) = attached([solved], [match], [organs], 1.0)
    assert before > 5
    for u in (0.25, 0.5, 0.75):
        assert cKDTree(at(after[0], u)).query(at(after[1], u))[0].min() < 1.1
    for u in (0.0, 1.0):
        np.testing.assert_array_equal(at(after[1], u), at(solved[1], u))


def test_the_tip_hardly_follows() -> None:
    leaf = (blade(), blade() + np.array([12.0, 0.0, 0.0]), blade())
    solved, match, organs = tasks_of(leaf)
    (after,) = attached([solved], [match], [organs], 1.0)
    moved = np.linalg.norm(at(after[1], 0.5) - at(solved[1], 0.5), axis=1)
    assert moved[0] > 4
    assert moved[-1] < 0.01


def test_what_is_attached_is_left_alone() -> None:
    solved, match, organs = tasks_of((blade(), blade()))
    (after,) = attached([solved], [match], [organs], 1.0)
    assert after[1] is solved[1]
