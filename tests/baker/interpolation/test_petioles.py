"""Petioles that belong to the stem: leaves stay at their ends, and the axis stays as it is."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

import baker
import gclip

LEAVES, HEIGHT, LENGTH = 4, 60.0, 22.0  # number of leaves; of the stem, and of blades


def rod(rng: np.random.Generator, start: np.ndarray, end: np.ndarray, count: int) -> np.ndarray:
    """(count, 3) points of a thin rod."""
    return start + np.outer(rng.random(count), end - start) + rng.normal(0.0, 0.6, (count, 3))


def plant(seed: int, turns: list[float], size: float, petiole: float = LENGTH) -> np.ndarray:
    """(n, 4) points and labels of a stem with petioles, label 0, and of a leaf on each of these.

    turns: of the petioles about the stem in degrees. size: factor on all lengths. petiole: their
    horizontal length.
    """
    rng, up = np.random.default_rng(seed), np.array([0.0, 0.0, 1.0])
    parts = [np.pad(rod(rng, 0 * up, HEIGHT * up, 900), ((0, 0), (0, 1)))]
    for leaf, turn in enumerate(turns):
        angle = np.radians(360.0 * leaf / LEAVES + turn)
        out, side = np.array(
            [[np.cos(angle), np.sin(angle), 0], [-np.sin(angle), np.cos(angle), 0]]
        )
        base = (25.0 + 9.0 * leaf) * up
        tip = base + petiole * (out + 0.6 * up)
        parts.append(np.pad(rod(rng, base, tip, 250), ((0, 0), (0, 1))))
        along, across = rng.random(500), rng.uniform(-0.5, 0.5, 500)
        width = np.sqrt(along - along**2) * across
        blade = tip + LENGTH * (np.outer(along, out - 0.2 * up) + np.outer(width, side))
        parts.append(np.column_stack([blade, np.full(500, leaf + 1)]))
    return np.concatenate(parts) * [size, size, size, 1.0]


def baked(folder: Path, *scans: np.ndarray) -> gclip.Clip:
    for day, scan in enumerate(scans):
        np.savetxt(folder / f"day{day}.txt", scan)
    return baker.bake([folder], baker.Options(align="none", up="z", labels="consistent"))


@pytest.mark.parametrize("turns", [[70, 70, 70, 70], [90, -20, 60, 0], [40, -40, 50, -30]])
def test_leaves_stay_on_petioles_that_turn(tmp_path: Path, turns: list[float]) -> None:
    clip = baked(tmp_path, plant(1, [0.0] * LEAVES, 1.0), plant(2, turns, 1.15))
    middle = clip.at(0.5)
    tree = cKDTree(middle.positions[middle.tracks == 0])
    for leaf in range(1, LEAVES + 1):
        assert tree.query(middle.positions[middle.tracks == leaf])[0].min() < 1.5


@pytest.mark.parametrize("turn", [0.0, 30.0])
def test_the_axis_moves_by_less_than_half_of_what_petioles_lengthen(
    tmp_path: Path, turn: float
) -> None:
    scans = plant(1, [0.0] * LEAVES, 1.0, 15.0), plant(2, [turn] * LEAVES, 1.0, 25.0)
    clip = baked(tmp_path, *scans)
    start, end = (clip.at(day).positions for day in (1e-6, 1.0 - 1e-6))
    is_axis = (clip.at(1e-6).tracks == 0) & (np.hypot(end[:, 0], end[:, 1]) < 2.0)
    assert np.median(np.abs(end[is_axis, 2] - start[is_axis, 2])) < 5.0


@pytest.mark.parametrize("is_longer", [(True, False), (False, True)])
def test_a_stem_that_loses_its_top_does_not_shrink(
    tmp_path: Path, is_longer: tuple[bool, bool]
) -> None:
    """The top of it may be hidden from the scanner, or labelled as something else."""
    up, scans = np.array([0.0, 0.0, 1.0]), []
    for day, has_top in enumerate(is_longer):
        top = rod(np.random.default_rng(day), HEIGHT * up, 1.4 * HEIGHT * up, 400 * has_top)
        scans.append(
            np.concatenate([plant(day, [0.0] * LEAVES, 1.0), np.pad(top, ((0, 0), (0, 1)))])
        )
    clip = baked(tmp_path, *scans)
    start, end = (clip.at(day).positions for day in (1e-6, 1.0 - 1e-6))
    is_axis = (clip.at(1e-6).tracks == 0) & (np.hypot(end[:, 0], end[:, 1]) < 2.0)
    is_below = is_axis & (np.minimum(start[:, 2], end[:, 2]) < 0.8 * HEIGHT)
    assert np.median(np.abs(end[is_below, 2] - start[is_below, 2])) < 1.5
