"""An organ laid on itself: limbs are found again wherever it has swung, however it has grown."""

import tracemalloc

import numpy as np
import pytest

from baker.matching.leaflets import register_leaflets
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
    registered, pairs = register_leaflets(before.points, moved, feet, before.leaf, after.leaf)
    assert pairs.tolist() == [[leaf, leaf] for leaf in range(LIMB)]
    assert registered.shape == before.points.shape


@pytest.mark.parametrize("seed", range(3))
def test_leaves_born_at_the_end_of_a_swinging_twig_are_no_others(seed):
    before, after = twig(4, seed), twig(7, seed + 9, stretch=1.2)
    feet = before.foot, after.foot
    moved = swung(after.points, 35, 1.1)
    _, pairs = register_leaflets(before.points, moved, feet, before.leaf, after.leaf)
    assert {(leaf, leaf) for leaf in range(4)} >= {tuple(pair) for pair in pairs.tolist()}
    assert len(pairs) >= 3


def test_limbs_in_one_place_lie_on_nothing_that_is_not_a_number():
    before = twig(4)
    flat = np.zeros_like(before.points)
    registered, _ = register_leaflets(
        before.points, flat, (before.foot, 0), before.leaf, before.leaf
    )
    assert np.isfinite(registered).all()


def test_an_organ_of_a_hundred_limbs_takes_little_memory():
    """All swings of all pairs of its limbs would take gigabytes."""
    before, after = twig(90), twig(90, 9)
    tracemalloc.start()
    pairs = register_leaflets(
        before.points, after.points, (before.foot, after.foot), before.leaf, after.leaf
    )[1]
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(pairs) > 80
    assert peak < 300e6
