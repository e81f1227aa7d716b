"""An organ laid on itself: limbs are found again wherever it has swung, however it has grown."""

import tracemalloc

import numpy as np
import pytest

from baker.matching.leaflet_registration import Limbs, laid_on, paired
from tests.baker.twigs import twig

LIMB = 6


def swung(points: np.ndarray, degrees: float, growth: float) -> np.ndarray:
    turn = np.radians(degrees)
    rotation = [[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]]
    return growth * points @ np.array(rotation).T + [3.0, 1.0, 0.0]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("degrees", [0, 40, 80])
@pytest.mark.parametrize("growth", [0.6, 1.0, 1.8])
def test_limbs_are_found_wherever_a_twig_has_swung(degrees, growth, seed):
    before, after = twig(LIMB, seed), twig(LIMB, seed + 9)
    moved = swung(after.points, degrees, growth)
    feet = before.foot, after.foot
    here, there, pairs = laid_on(before.points, moved, feet, before.leaf, after.leaf)
    assert pairs.tolist() == [[leaf, leaf] for leaf in range(LIMB)]
    assert here.shape == before.points.shape
    assert there.shape == moved.shape


@pytest.mark.parametrize("seed", range(3))
def test_leaves_born_at_the_end_of_a_swinging_twig_are_no_others(seed):
    before, after = twig(4, seed), twig(7, seed + 9, stretch=1.2)
    feet = before.foot, after.foot
    moved = swung(after.points, 35, 1.1)
    _, _, pairs = laid_on(before.points, moved, feet, before.leaf, after.leaf)
    assert {(leaf, leaf) for leaf in range(4)} >= {tuple(pair) for pair in pairs.tolist()}
    assert len(pairs) >= 3


def test_limbs_in_one_place_lie_on_nothing_that_is_not_a_number():
    before = twig(4)
    flat = np.zeros_like(before.points)
    here, there, _ = laid_on(before.points, flat, (before.foot, 0), before.leaf, before.leaf)
    assert np.isfinite(here).all()
    assert np.isfinite(there).all()


def test_an_organ_of_a_hundred_limbs_takes_little_memory():
    """All swings of all pairs of its limbs would take gigabytes."""
    before, after = twig(90), twig(90, 9)
    tracemalloc.start()
    pairs = laid_on(
        before.points, after.points, (before.foot, after.foot), before.leaf, after.leaf
    )[2]
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(pairs) > 80
    assert peak < 300e6


@pytest.mark.parametrize(("away", "same"), [(0.0, True), (1.9, True), (2.1, False), (50.0, False)])
def test_limbs_two_radii_apart_are_not_the_same(away: float, same: bool):
    first, second = (
        Limbs(np.array([[x, 0.0, 0.0]]), np.array([r]), np.array([10.0]), 10)
        for x, r in ((0.0, 1.0), (away, 0.5))
    )
    pairs, worth = paired(first, second)
    assert pairs.tolist() == ([[0, 0]] if same else [])
    assert (worth > 0) == same
