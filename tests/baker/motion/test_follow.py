"""An organ drawn to its bearer: what is looked at, and that it comes closer."""

from __future__ import annotations

import numpy as np
import pytest

from baker.motion.follow import balls, beside, follow, moved
from gclip.evaluate import bernstein

INSTANTS = np.array([bernstein(2, u) for u in np.linspace(0, 1, 9)])


def curves(count: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(3, count, 3)).astype(np.float32)


@pytest.mark.parametrize("most", [5, 1000])
def test_beside_are_the_nearest_within_the_margin(most: int) -> None:
    a, b = curves(70, 0), curves(90, 1)
    weights = np.array([bernstein(2, 0.4)])
    here, there = (np.tensordot(weights[0], curve.astype(float), axes=1) for curve in (a, b))
    apart = np.linalg.norm(here[:, None] - there, axis=2)
    gaps, near, nearby = beside(
        a, b, moved(balls(a), weights), moved(balls(b), weights), weights, weights, 1.0, most
    )
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
    gaps, _, passing = beside(
        leaf,
        stem,
        moved(balls(leaf), weights),
        moved(balls(stem), weights),
        weights,
        weights,
        0.01,
        3,
    )
    np.testing.assert_allclose(gaps, 0, atol=1e-6)
    assert passing.tolist() == [*range(0, 101, 10)]


def test_of_many_that_are_equally_near_an_even_share_is_looked_at() -> None:
    bearer, bud = np.zeros((1, 1, 3)), np.zeros((1, 500, 3))
    one = np.ones((1, 1))
    near = beside(
        bud, bearer, moved(balls(bud), one), moved(balls(bearer), one), one, one, 1.0, 50
    )[1]
    assert near.tolist() == [*range(0, 500, 10)]


def test_an_organ_is_drawn_to_its_bearer_and_its_ends_stay() -> None:
    bearer = np.zeros((3, 30, 3), np.float32)
    bearer[:, :, 0] = np.linspace(0, 3, 30)
    organ = bearer + np.float32([0, 0, 0.1])
    organ[1, :, 2] += 4  # it leaves its bearer on the way, by two half-way
    every = np.arange(30)
    numbers = (0.1, 0.05, 0.02, 6, 0.375, 0.5)
    drawn, changed, gaps, mine, theirs = follow(organ, every, bearer, every, INSTANTS, *numbers)
    assert changed
    assert gaps.max() <= 0.15 + 1e-6
    np.testing.assert_array_equal(drawn[[0, 2]], organ[[0, 2]])
    here, there = (np.tensordot(INSTANTS, c.astype(float), axes=1) for c in (drawn, bearer))
    at = np.arange(len(INSTANTS))
    np.testing.assert_allclose(np.linalg.norm(here[at, mine] - there[at, theirs], axis=1), gaps)


def test_an_organ_that_stays_with_its_bearer_is_left_as_it_is() -> None:
    organ, every = curves(20, 1), np.arange(20)
    numbers = (1.0, 0.1, 0.1, 6, 0.375, 0.5)
    drawn, changed, gaps, *_ = follow(organ, every, organ, every, INSTANTS, *numbers)
    assert not changed
    assert not gaps.any()
    np.testing.assert_array_equal(drawn, organ)
