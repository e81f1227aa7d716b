"""Organs stay attached between the scans."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from baker.interpolation.movers import OrganMovers
from baker.interpolation.organ_attachments import attachments
from baker.interpolation.paths import attached
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy
from gclip.evaluate import bernstein
from gclip.pack import Movers
from gclip.schema import Motion

COUNT = 200
TOLERANCE = 3.0  # point spacings


def at(moved: OrganMovers, u: float) -> np.ndarray:
    curve = moved.movers.curve
    return np.tensordot(bernstein(len(curve) - 1, u), np.stack(curve), axes=1)


def tasks_of(
    leaf: tuple[np.ndarray, ...], stem: tuple[np.ndarray, ...] | None = None, born: bool = False
) -> tuple[list[OrganMovers], Hierarchy]:
    """A stem that stands at x = 0 or moves as given, and a leaf, on the given paths."""
    upright = np.column_stack([np.zeros((COUNT, 2)), np.linspace(0, 50, COUNT)])
    first, second = np.arange(COUNT), np.arange(COUNT, 2 * COUNT)
    hierarchy = Hierarchy((first, second), (0, 1), (NO_PARENT, 0), 0, organs=(0, 1))
    moved = [
        OrganMovers(
            Movers(Motion.MOVE, tuple(p.astype(np.float32) for p in curve), np.full(COUNT, organ)),
            None,
            np.ones(COUNT),
            members,
            members,
            born=bool(organ) and born,
        )
        for organ, members, curve in ((0, first, stem or (upright, upright)), (1, second, leaf))
    ]
    return moved, hierarchy


def held(solved: list[OrganMovers], scan: Hierarchy) -> list[OrganMovers]:
    """The tasks with organs held at their parents, at a point spacing of 1."""
    end = np.concatenate([moved.movers.curve[-1] for moved in solved])
    return attached(solved, scan, attachments(end, scan), 1.0)


def widening(moved: list[OrganMovers]) -> float:
    """How far the leaf parts from the stem beyond the larger gap at the scans, at 50 instants."""
    gaps = [cKDTree(at(moved[0], u)).query(at(moved[1], u))[0].min() for u in np.linspace(0, 1, 52)]
    return float(max(gaps) - max(gaps[0], gaps[-1]))


def blade() -> np.ndarray:
    along = np.linspace(0.5, 40, COUNT)
    return np.column_stack([along, 0 * along, 25 + 0 * along])


def test_a_base_that_would_leave_its_stem_stays() -> None:
    leaf = (blade(), blade() + np.array([12.0, 0.0, 0.0]), blade())
    solved, scan = tasks_of(leaf)
    assert widening(solved) > TOLERANCE
    after = held(solved, scan)
    assert widening(after) < TOLERANCE
    assert len(after[1].movers) == COUNT  # drawn to its stem, which needs no mover to span a gap
    for u in (0.0, 1.0):
        np.testing.assert_array_equal(
            np.unique(at(after[1], u), axis=0), np.unique(at(solved[1], u), axis=0)
        )


def test_a_gap_that_the_scans_show_is_kept() -> None:
    """Drawn as near as at the scans, not onto the stem."""
    away = blade() + np.array([10.0, 0.0, 0.0])
    solved, scan = tasks_of((away, away + np.array([12.0, 0.0, 0.0]), away))
    after = held(solved, scan)
    gap = cKDTree(at(after[0], 0.5)).query(at(after[1], 0.5))[0].min()
    assert gap == pytest.approx(10.5, abs=1.0)


def swinging() -> tuple[np.ndarray, ...]:
    """A stem that bends aside and comes back."""
    upright = np.column_stack([np.zeros((COUNT, 2)), np.linspace(0, 50, COUNT)])
    return upright, upright + np.array([20.0, 9.0, 0.0]), upright


@pytest.mark.parametrize("degree", [1, 2])
def test_no_path_parts_an_organ_from_its_stem(degree: int) -> None:
    aside = np.array([8.0, 0.0, 6.0])
    leaf = {
        1: (blade(), blade()[::-1] + aside * [0, 0, 1]),
        2: (blade(), blade() + aside, blade()),
    }[degree]
    solved, scan = tasks_of(leaf, swinging())
    assert widening(solved) > TOLERANCE
    after = held(solved, scan)
    assert widening(after) < TOLERANCE


def test_what_is_born_unfolds_from_its_stem() -> None:
    bud = np.tile([0.0, 0.0, 25.0], (COUNT, 1))
    solved, scan = tasks_of((bud, (bud + blade()) / 2, blade()), swinging(), born=True)
    assert widening(solved) > TOLERANCE
    after = held(solved, scan)
    assert widening(after) < TOLERANCE


def test_the_tip_hardly_follows() -> None:
    leaf = (blade(), blade() + np.array([12.0, 0.0, 0.0]), blade())
    solved, scan = tasks_of(leaf)
    after = held(solved, scan)
    moved = np.linalg.norm(at(after[1], 0.5)[:COUNT] - at(solved[1], 0.5), axis=1)
    assert moved[0] > 4
    assert moved[-1] < 0.01


def test_what_is_attached_is_left_alone() -> None:
    solved, scan = tasks_of((blade(), blade()))
    after = held(solved, scan)
    assert after[1] is solved[1]


def test_a_child_follows_a_parent_that_is_itself_shifted() -> None:
    """A branch that leaves its stem half-way, and on it a leaf that goes along with the branch."""
    aside = np.array([0.0, 9.0, 0.0])
    solved, _ = tasks_of((blade(), blade() + aside, blade()))
    twig = 0.3 * blade() + [4.0, 0.0, 17.5]
    curve = tuple(p.astype(np.float32) for p in (twig, twig + aside, twig))
    movers = replace(solved[1].movers, curve=curve, tracks=np.full(COUNT, 2))
    solved.append(replace(solved[1], movers=movers))
    segments = tuple(np.arange(k * COUNT, (k + 1) * COUNT) for k in range(3))
    hierarchy = Hierarchy(segments, (0, 1, 2), (NO_PARENT, 0, 1), 0, organs=(0, 1, 2))
    after = held(solved, hierarchy)
    assert widening(after) < TOLERANCE
    assert widening(after[1:]) < TOLERANCE


def stem_and_leaf(count: int) -> tuple[np.ndarray, Hierarchy]:
    """An upright stem and a leaf of `count` points that leaves it at height 5, tip first."""
    stem = np.stack([np.zeros(50), np.zeros(50), np.linspace(0, 10, 50)], axis=1)
    along = np.linspace(4, 0.2, count)
    leaf = np.stack([along, np.zeros(count), 5 + along], axis=1)
    segments = np.arange(50), np.arange(50, 50 + count)
    return np.concatenate([stem, leaf]), Hierarchy(
        segments, (0, 1), (NO_PARENT, 0), 0, organs=(0, 1)
    )


@pytest.mark.parametrize("count", [30, 200, 1000])
def test_an_attachment_point_is_nearest_to_the_parent(count: int) -> None:
    points, hierarchy = stem_and_leaf(count)
    found = attachments(points, hierarchy)
    assert set(found) == {1}  # the root has none
    leaf = points[hierarchy.segments[1]]
    assert found[1].nearest == count - 1
    assert found[1].gap == pytest.approx(cKDTree(points[:50]).query(leaf)[0].min())


def test_what_lies_on_its_parent_is_attached_without_a_gap() -> None:
    points, hierarchy = stem_and_leaf(200)
    points[60] = points[25]
    assert attachments(points, hierarchy)[1] == (10, 0.0)


def test_under_an_empty_root_there_is_none() -> None:
    points, _ = stem_and_leaf(30)
    empty = Hierarchy((np.arange(80), np.empty(0, int)), (1, None), (1, NO_PARENT), 1)
    assert attachments(points, empty) == {}
