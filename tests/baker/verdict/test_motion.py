"""How organs move, judged from their movers alone."""

from __future__ import annotations

import numpy as np
import pytest

from baker import Options, bake
from baker.verdict.motion import motion_faults, order_correlation
from traits.doubts import doubts_of

BASE = np.array([[0.0, 0.0, 0.0], [0.0, 2.0, 0.0]])


@pytest.fixture
def leaf() -> np.ndarray:
    """(400, 3) a leaf of length 10 and width 2 along x, its base at the origin."""
    return np.random.default_rng(0).random((400, 3)) * [10, 2, 0.1]


def moved(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    return np.stack([start, end])


def faults(ends: np.ndarray) -> dict[str, float]:
    """Strength of each fault, where the organ is attached at its base."""
    return dict(motion_faults(ends, [BASE, BASE]))


def turned(points: np.ndarray, degrees: float) -> np.ndarray:
    """About the y axis."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return points @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]]).T


@pytest.mark.parametrize("degrees", [0, 20, 40])
@pytest.mark.parametrize("growth", [1, 1.5, 3])
def test_growing_and_bending_is_nothing_wrong(leaf, degrees, growth):
    found = faults(moved(leaf, turned(leaf * [growth, growth, 1], degrees)))
    assert found["{} tears"] == 0.0
    assert found["parts of {} change places"] < 0.1
    assert max(found.values()) < 0.5


def test_an_organ_that_is_slit_tears_and_so_does_one_that_comes_together(leaf):
    slit = leaf.copy()
    slit[leaf[:, 1] > 1] += [0, 0, 8]
    assert faults(moved(leaf, slit))["{} tears"] > 0.4
    assert faults(moved(slit, leaf))["{} tears"] == faults(moved(leaf, slit))["{} tears"]


def test_a_tip_that_becomes_the_base_is_out_of_order(leaf):
    found = faults(moved(leaf, [10, 0, 0] - leaf * [1, -1, -1]))
    assert found["the tip and the base of {} change places"] > 3.8


def test_the_order_counts_from_the_attachment_wherever_that_is(leaf):
    tip = BASE + np.array([10, 0, 0])
    assert order_correlation(moved(leaf, leaf), [tip, tip]) > 0.95
    assert order_correlation(moved(leaf, leaf), [BASE, tip]) < -0.9


@pytest.mark.parametrize("count", [3, 59])
def test_few_points_tell_nothing(leaf, count):
    assert not faults(moved(leaf[:count], leaf[:count]))


def test_what_unfolds_from_few_points_is_not_judged(leaf):
    assert not faults(moved(leaf[np.arange(400) % 10], leaf))


@pytest.mark.parametrize("petiole", [0, 1])
def test_a_leaf_whose_petiole_becomes_stem_comes_off(tmp_path, petiole):
    """It draws back along its petiole, towards which the stem grows."""
    rng = np.random.default_rng(0)
    for day in range(2):
        rods = (900, [0, 0, 0], [0, 0, 60]), (400, [0, 0, 40], [30, 0, 40])
        parts = [start + rng.random((n, 1)) * np.subtract(end, start) for n, start, end in rods]
        blade = rng.random((900, 3)) * [30, 16, 0.1] + [30, -8, 40]
        points = np.concatenate([*parts, blade]) + rng.normal(0, 0.3, (2200, 3))
        labels = np.repeat([0, 1 if day == 0 else petiole, 1], [900, 400, 900])
        np.savetxt(tmp_path / f"day{day}.txt", np.c_[points, labels])
    clip = bake([tmp_path], Options(align="none", up="z", labels="consistent"))
    found = [doubt.what for doubt in doubts_of(clip)]
    assert found == ["leaf 1 comes off"] * (petiole == 0)
