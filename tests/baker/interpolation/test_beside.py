"""What is nearest is nearest among all, whatever is passed over."""

from __future__ import annotations

import numpy as np
import pytest

from baker.interpolation.beside import LEAST, balls, gaps_of, widest
from gclip.evaluate import bernstein

COUNTS = [1, LEAST - 1, LEAST, LEAST + 1, 70 * LEAST + 3]  # with the last, balls within balls
WEIGHTS = np.array([bernstein(3, u) for u in (0.0, 0.2, 0.5, 0.8, 1.0)])
EVERY = np.arange(len(WEIGHTS))


def clouds(mine: int, theirs: int) -> tuple[np.ndarray, np.ndarray]:
    """The control points of two clouds that overlap a little."""
    rng = np.random.default_rng(mine + theirs)
    a = np.sort(rng.normal(size=(4, mine, 3)), axis=1)
    b = np.sort(rng.normal(size=(4, theirs, 3)), axis=1) + np.array([3.0, 0.0, 0.0])
    return a, b


def apart(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(I, a, b) the distances of all pairs at each instant."""
    here, there = (np.tensordot(WEIGHTS, curve, axes=1) for curve in (a, b))
    return np.linalg.norm(here[:, :, None] - there[:, None], axis=3)


def moving(curve: np.ndarray, weights: np.ndarray = WEIGHTS) -> tuple[np.ndarray, ...]:
    return curve, balls(curve), weights


@pytest.mark.parametrize("mine", COUNTS)
@pytest.mark.parametrize("theirs", COUNTS)
@pytest.mark.parametrize("enough", [0.0, 0.5, 1.5])
def test_the_widest_gap_is_that_of_all_pairs(mine: int, theirs: int, enough: float) -> None:
    a, b = clouds(mine, theirs)
    pairs = apart(a, b)
    gaps = pairs.min(axis=(1, 2))
    found, first, second = widest(moving(a), moving(b), EVERY % mine, EVERY % theirs, enough)
    np.testing.assert_allclose(pairs[EVERY, first, second], found, rtol=1e-12)
    if gaps.max() > enough:
        assert found.max() == pytest.approx(gaps.max(), rel=1e-12)
        assert gaps[np.argmax(found)] == pytest.approx(gaps.max(), rel=1e-12)
    else:
        assert found.max() <= enough


@pytest.mark.parametrize("mine", COUNTS)
@pytest.mark.parametrize("theirs", COUNTS)
@pytest.mark.parametrize("turned", [False, True])
def test_gaps_that_widen_are_told_of_all_pairs(mine: int, theirs: int, turned: bool) -> None:
    a, b = clouds(mine, theirs)
    for later in range(4):  # beside one another, or far apart
        b[1:3, :, 2] += later
        here, there = (a[::-1].copy(), b[::-1].copy()) if turned else (a, b)
        pairs = apart(here, there)
        gaps = pairs.min(axis=(1, 2))
        widening = gaps.max() - max(gaps[0], gaps[-1])
        for allowed in {0.0, max(widening - 1e-6, 0.0), widening + 1e-6}:
            found, first, second = gaps_of(moving(here), moving(there), allowed)
            limit = max(found[0], found[-1]) + allowed
            assert (found.max() > limit) == (widening > allowed)
            if widening > allowed:
                np.testing.assert_allclose(pairs[EVERY, first, second], found, rtol=1e-12)
                np.testing.assert_allclose(found[[0, -1]], gaps[[0, -1]], rtol=1e-12)
                assert found.max() == pytest.approx(gaps.max(), rel=1e-12)


def test_points_that_touch() -> None:
    same, begin = np.zeros((2, 20, 3)), np.array([3, 3])
    gaps, a, b = widest(moving(same, np.eye(2)), moving(same, np.eye(2)), begin, begin, 0.0)
    assert gaps.tolist() == [0.0, 0.0]
    assert a.tolist() == b.tolist() == [3, 3]


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


def test_who_passes_by_between_the_scans_is_near() -> None:
    """A stem's points slide past a leaf's base: others are beside it at every instant."""
    leaf, stem = np.zeros((2, 1, 3), np.float32), np.zeros((2, 101, 3), np.float32)
    stem[0, :, 2] = np.linspace(0, 10, 101)
    stem[1, :, 2] = np.linspace(-10, 0, 101)
    weights = np.array([bernstein(1, u) for u in np.linspace(0, 1, 11)])
    gaps, _, passing = gaps_of(moving(leaf, weights), moving(stem, weights), 0.01)
    np.testing.assert_allclose(gaps, 0, atol=1e-6)
    assert passing[1:].tolist() == [*range(10, 101, 10)]
