"""An organ drawn to its bearer: it comes closer, and its ends stay."""

from __future__ import annotations

import numpy as np

from baker.motion.follow import follow
from gclip.evaluate import bernstein

INSTANTS = np.array([bernstein(2, u) for u in np.linspace(0, 1, 9)])


def curves(count: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(3, count, 3)).astype(np.float32)


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
