"""The tip of a shoot becomes the leaf that is labelled in the next scan."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

import baker
import gclip
from tests.baker.interpolation.test_petioles import HEIGHT, LEAVES, plant
from traits import measure

TURNS = [0.0] * LEAVES
TIP = 18.0  # length of the shoot above the stem


def shoot(seed: int, length: float, label: int) -> np.ndarray:
    """(n, 4) points of a narrow upright blade on top of the stem."""
    rng = np.random.default_rng(seed)
    along = rng.random(round(20 * length))
    blade = np.column_stack([0.3 * length * along**2, 4.0 * rng.random(len(along)) - 2.0])
    return np.column_stack([blade, HEIGHT + length * along, np.full(len(along), label)])


def baked(folder: Path, *scans: list[np.ndarray], **options: object) -> gclip.Clip:
    for day, parts in enumerate(scans):
        np.savetxt(folder / f"day{day}.txt", np.concatenate(parts))
    fixed = {"align": "none", "up": "z", "labels": "consistent", "even": 0.0}
    return baker.bake([folder], baker.Options(**fixed | options))


@pytest.fixture
def tip_becomes_leaf(tmp_path: Path) -> gclip.Clip:
    first = [plant(1, TURNS, 1.0), shoot(1, TIP, 0)]
    return baked(tmp_path, first, [plant(2, TURNS, 1.05), shoot(2, 1.3 * TIP, LEAVES + 1)])


def test_the_tip_neither_sinks_nor_grows_a_second_time(tip_becomes_leaf: gclip.Clip) -> None:
    tops = [np.sort(tip_becomes_leaf.at(day).local[:, 2])[-20] for day in np.linspace(0, 1, 9)]
    assert np.diff(tops).min() > -0.5


def test_the_tip_becomes_the_leaf(tip_becomes_leaf: gclip.Clip) -> None:
    start, end = (tip_becomes_leaf.at(day) for day in (1e-6, 1.0 - 1e-6))
    is_tip = start.local[:, 2] > HEIGHT + 0.3 * TIP
    assert (end.tracks[is_tip] == LEAVES + 1).mean() > 0.95
    is_leaf = end.tracks == LEAVES + 1
    heights = start.local[is_leaf, 2], end.local[is_leaf, 2]
    assert np.corrcoef(*heights)[0, 1] > 0.95


def test_the_leaf_is_still_one_that_is_born(tip_becomes_leaf: gclip.Clip) -> None:
    born = {pair.track for pair in tip_becomes_leaf.intervals[0].segments if pair.event == "birth"}
    assert born == {LEAVES + 1}
    assert tip_becomes_leaf.track_table[LEAVES + 1].born == 1.0


def test_the_scans_are_met(tip_becomes_leaf: gclip.Clip, tmp_path: Path) -> None:
    for day in (0, 1):
        scan, shown = np.loadtxt(tmp_path / f"day{day}.txt")[:, :3], tip_becomes_leaf.at(day)
        for some, all_others in ((scan, shown.positions), (shown.positions, scan)):
            assert cKDTree(all_others).query(some)[0].max() < 0.02


def test_the_stem_keeps_its_tip_at_the_scan_and_its_height_does_not_jump(
    tip_becomes_leaf: gclip.Clip,
) -> None:
    heights = [measure(tip_becomes_leaf, day)[1].height for day in (0.0, 1e-5)]
    assert heights[0] > HEIGHT + 0.8 * TIP
    assert heights[1] == pytest.approx(heights[0], rel=0.01)


def test_a_leaf_without_primordium_takes_little_of_the_stem(tmp_path: Path) -> None:
    second = [plant(2, TURNS, 1.0), shoot(2, TIP, LEAVES + 1)]
    clip = baked(tmp_path, [plant(1, TURNS, 1.0)], second)
    (birth,) = (pair for pair in clip.intervals[0].segments if pair.event == "birth")
    assert birth.start_points <= 20


def test_a_petiole_that_carries_a_leaf_is_no_primordium(tmp_path: Path) -> None:
    """Even if a new leaf lies where the petiole was."""
    rng, turned = np.random.default_rng(3), [0.0, 0.0, 0.0, 60.0]
    first, second = plant(1, TURNS, 1.0), plant(2, turned, 1.0)
    on_petiole = first[(first[:, 3] == 0) & (np.hypot(*first[:, :2].T) > 6) & (first[:, 2] > 50)]
    new = on_petiole + rng.normal(0.0, 0.3, on_petiole.shape) * [1, 1, 1, 0] + [0, 0, 0, LEAVES + 1]
    clip = baked(tmp_path, [first], [second, new])
    pairs = {pair.track: pair for pair in clip.intervals[0].segments}
    assert pairs[LEAVES + 1].event == "birth"
    assert pairs[LEAVES + 1].start_points <= 20


def test_the_paper_has_no_primordia(tmp_path: Path) -> None:
    first = [plant(1, TURNS, 1.0), shoot(1, TIP, 0)]
    second = [plant(2, TURNS, 1.05), shoot(2, 1.3 * TIP, LEAVES + 1)]
    clip = baked(tmp_path, first, second, paper=True)
    (birth,) = (pair for pair in clip.intervals[0].segments if pair.event == "birth")
    assert birth.start_points <= 100
