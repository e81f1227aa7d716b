"""What is nearest is nearest among all, whatever is passed over, and what is near is looked at."""

from __future__ import annotations

import numpy as np
import pytest

from baker.motion.beside import LEAST, balls, beside, closest, moved, parted, within
from gclip.evaluate import bernstein

COUNTS = [1, LEAST - 1, LEAST, LEAST + 1, 70 * LEAST + 3]  # with the last, balls within balls


def clouds(mine: int, theirs: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Two clouds at four instants, overlapping a little, and the distances of all their pairs."""
    rng = np.random.default_rng(mine + theirs)
    a = np.sort(rng.normal(size=(4, mine, 3)), axis=1)
    b = np.sort(rng.normal(size=(4, theirs, 3)), axis=1) + np.array([3.0, 0.0, 0.0])
    return a, b, np.linalg.norm(a[:, :, None] - b[:, None], axis=3)


def curves(count: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(3, count, 3)).astype(np.float32)


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
        around = moved(balls(a), weights[k]), moved(balls(b), weights[k])
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


@pytest.mark.parametrize("most", [5, 1000])
def test_beside_are_the_nearest_within_the_margin(most: int) -> None:
    a, b = curves(70, 0), curves(90, 1)
    weights = np.array([bernstein(2, 0.4)])
    here, there = (np.tensordot(weights[0], curve.astype(float), axes=1) for curve in (a, b))
    apart = np.linalg.norm(here[:, None] - there, axis=2)
    gaps, near, nearby = beside(a, b, balls(a), balls(b), weights, weights, 1.0, most)
    assert gaps[0] == pytest.approx(apart.min())
    own = apart.min(axis=1)
    within = np.flatnonzero(own <= apart.min() + 1.0)
    expected = np.sort(within[np.argsort(own[within])][:most])
    assert near.tolist() == expected.tolist()
    other = apart[near].min(axis=0)
    met = np.flatnonzero(other <= apart.min() + 1.0)
    assert nearby.tolist() == np.sort(met[np.argsort(other[met])][:most]).tolist()


def test_who_passes_by_between_the_scans_is_near() -> None:
    """A stem's points slide past a leaf's base: others are beside it at every instant."""
    leaf, stem = np.zeros((2, 1, 3), np.float32), np.zeros((2, 101, 3), np.float32)
    stem[0, :, 2] = np.linspace(0, 10, 101)
    stem[1, :, 2] = np.linspace(-10, 0, 101)
    weights = np.array([bernstein(1, u) for u in np.linspace(0, 1, 11)])
    both = leaf, stem, balls(leaf), balls(stem), weights, weights
    gaps, _, passing = beside(*both, 0.01, 3)
    np.testing.assert_allclose(gaps, 0, atol=1e-6)
    assert passing.tolist() == [*range(0, 101, 10)]
    assert not parted(*both, 0.01)
    assert parted(leaf, stem[:, ::20], balls(leaf), balls(stem[:, ::20]), weights, weights, 0.01)


@pytest.mark.parametrize("mine", COUNTS)
@pytest.mark.parametrize("theirs", COUNTS)
def test_who_parts_is_told_of_all_pairs(mine: int, theirs: int) -> None:
    a, b, _ = clouds(mine, theirs)
    weights = np.array([bernstein(3, u) for u in (0.0, 0.2, 0.5, 0.8, 1.0)])
    for later in range(0, 4):
        there = b + np.float64([0.0, 0.0, later])  # beside one another, or far apart
        around = balls(a), balls(there)
        gaps = closest(a, there, *around, weights)[0]
        by = gaps.max() - max(gaps[0], gaps[-1])
        for allowed in (0.0, by - 1e-6, by + 1e-6):
            found = parted(a, there, *around, weights, weights, max(allowed, 0.0))
            assert found == (by > max(allowed, 0.0))


def test_of_many_that_are_equally_near_an_even_share_is_looked_at() -> None:
    bearer, bud = np.zeros((1, 1, 3)), np.zeros((1, 500, 3))
    one = np.ones((1, 1))
    near = beside(bud, bearer, balls(bud), balls(bearer), one, one, 1.0, 50)[1]
    assert near.tolist() == [*range(0, 500, 10)]
