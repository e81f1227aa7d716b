"""What is nearest is nearest among all, whatever is passed over."""

from __future__ import annotations

import numpy as np
import pytest

from baker.motion.follow import LEAST, balls, closest, moved, within
from gclip.evaluate import bernstein

COUNTS = [1, LEAST - 1, LEAST, LEAST + 1, 70 * LEAST + 3]  # with the last, balls within balls


def clouds(mine: int, theirs: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Two clouds at four instants, overlapping a little, and the distances of all their pairs."""
    rng = np.random.default_rng(mine + theirs)
    a = np.sort(rng.normal(size=(4, mine, 3)), axis=1)
    b = np.sort(rng.normal(size=(4, theirs, 3)), axis=1) + np.array([3.0, 0.0, 0.0])
    return a, b, np.linalg.norm(a[:, :, None] - b[:, None], axis=3)


def within_at(mine: np.ndarray, theirs: np.ndarray, reach: float, most: int) -> tuple:
    """`within` of two clouds that stand still."""
    one = np.ones(1)
    around = balls(mine)[0], balls(theirs)[0]
    found, away = within(mine, theirs, *around, one, one, reach, most, mine.shape[1] // 2)
    order = np.argsort(found)
    return found[order], away[order]


@pytest.mark.parametrize("mine", COUNTS)
@pytest.mark.parametrize("theirs", COUNTS)
def test_the_closest_on_curves(mine: int, theirs: int) -> None:
    a, b, _ = clouds(mine, theirs)
    weights = np.array([bernstein(3, u) for u in (0.0, 0.3, 0.5, 1.0)])
    here, there = (np.tensordot(weights, curve, axes=1) for curve in (a, b))
    apart = np.linalg.norm(here[:, :, None] - there[:, None], axis=3)
    gap, first, second = closest(a, b, balls(a), balls(b), weights)
    np.testing.assert_allclose(gap, apart.min(axis=(1, 2)), rtol=1e-12)
    np.testing.assert_allclose(apart[np.arange(4), first, second], gap, rtol=1e-12)
    for k in range(4):
        around = moved(balls(a), weights)[k], moved(balls(b), weights)[k]
        found, away = within(a, b, *around, weights[k], weights[k], 2.0, 10**9, mine - 1)
        nearest = apart[k].min(axis=1)
        assert sorted(found) == np.flatnonzero(nearest <= 2.0).tolist()
        np.testing.assert_allclose(away, nearest[found], rtol=1e-12)


@pytest.mark.parametrize("mine", COUNTS)
@pytest.mark.parametrize("theirs", COUNTS)
def test_the_closest_of_all_pairs(mine: int, theirs: int) -> None:
    a, b, apart = clouds(mine, theirs)
    gap, first, second = closest(a, b, balls(a), balls(b), np.eye(4))
    np.testing.assert_allclose(gap, apart.min(axis=(1, 2)), rtol=1e-12)
    np.testing.assert_allclose(apart[np.arange(4), first, second], gap, rtol=1e-12)


@pytest.mark.parametrize("mine", COUNTS)
@pytest.mark.parametrize("theirs", COUNTS)
@pytest.mark.parametrize("reach", [0.0, 1.5, np.inf])
def test_points_within_reach(mine: int, theirs: int, reach: float) -> None:
    a, b, apart = clouds(mine, theirs)
    found, away = within_at(a[:1], b[:1], reach, 10**9)
    nearest = apart[0].min(axis=1)
    assert found.tolist() == np.flatnonzero(nearest <= reach).tolist()
    np.testing.assert_allclose(away, nearest[found], rtol=1e-12)


@pytest.mark.parametrize("most", [1, 3, 40])
@pytest.mark.parametrize("mine", COUNTS)
@pytest.mark.parametrize("theirs", COUNTS)
def test_the_nearest_points_within_reach(mine: int, theirs: int, most: int) -> None:
    a, b, _ = clouds(mine, theirs)
    a[0, mine // 2 :: 3] = a[0, mine // 2]  # in one place, as movers of a bud are
    nearest = np.linalg.norm(a[0, :, None] - b[0], axis=2).min(axis=1)
    farthest = np.sort(nearest)[min(most, mine) - 1]
    found, away = within_at(a[:1], b[:1], 8.0, most)
    assert found.tolist() == np.flatnonzero(nearest <= min(farthest, 8.0)).tolist()
    np.testing.assert_allclose(away, nearest[found], rtol=1e-12)


def test_points_that_touch() -> None:
    same = np.zeros((2, 20, 3))
    gap, a, b = closest(same, same, balls(same), balls(same), np.eye(2))
    assert gap.tolist() == [0.0, 0.0]
    assert a.tolist() == b.tolist() == [0, 0]
    found, away = within_at(same[:1], same[:1], 0.0, 50)
    assert found.tolist() == [*range(20)]
    assert away.tolist() == [0.0] * 20


@pytest.mark.parametrize("count", COUNTS)
def test_every_point_is_in_its_balls(count: int) -> None:
    points = np.random.default_rng(count).normal(size=(1, count, 3))
    found = balls(points)[0]
    small = -(-count // LEAST)
    size = LEAST * max(1, int(np.sqrt(count)) // LEAST)
    assert len(found) == small + -(-count // size)
    for owner in (np.arange(count) // LEAST + len(found) - small, np.arange(count) // size):
        away = np.linalg.norm(points[0] - found[owner, :3], axis=1)
        assert (away <= found[owner, 3]).all()
