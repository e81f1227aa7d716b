"""An organ drawn to its bearer: it comes closer, and its ends stay."""

from __future__ import annotations

import numpy as np
import pytest

from baker.interpolation.beside import balls, widest
from baker.interpolation.follow import follow
from gclip.evaluate import bernstein

INSTANTS = np.array([bernstein(2, u) for u in np.linspace(0, 1, 9)])


def met(organ: np.ndarray, bearer: np.ndarray) -> tuple:
    """What `follow` is told of an organ and its bearer."""
    none = np.zeros(len(INSTANTS), np.int64)
    moving, theirs = (organ, balls(organ), INSTANTS), (bearer, balls(bearer), INSTANTS)
    return organ, INSTANTS, theirs, widest(moving, theirs, none, none, 0.0)


def test_an_organ_is_drawn_to_its_bearer_and_its_ends_stay() -> None:
    bearer = np.zeros((3, 30, 3), np.float32)
    bearer[:, :, 0] = np.linspace(0, 3, 30)
    organ = bearer + np.float32([0, 0, 0.1])
    organ[1, :, 2] += 4  # it leaves its bearer on the way, by two half-way
    drawn, gap = follow(*met(organ, bearer), 0.15, 0.12, 0.12, 6, 0.375, 0.5)
    assert gap <= 0.15
    np.testing.assert_array_equal(drawn[[0, 2]], organ[[0, 2]])
    assert met(drawn, bearer)[-1][0].max() == pytest.approx(gap)


def test_an_organ_that_stays_with_its_bearer_is_left_as_it_is() -> None:
    organ = np.random.default_rng(1).normal(size=(3, 20, 3)).astype(np.float32)
    drawn, gap = follow(*met(organ, organ), 1.1, 1.05, 1.1, 6, 0.375, 0.5)
    assert drawn is organ
    assert gap == 0
