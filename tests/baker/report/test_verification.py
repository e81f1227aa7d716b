"""Verification by leaving scans out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from baker import InputError, Options
from baker.alignment.keyframes import Keyframe, hold_out
from baker.pipeline import bake_with_survey
from tests.baker.series import series_of
from traits.holdout_error import overall, verify

PLAIN = Options(align="none", up="z", paths="straight", workers=1)


def left_out(scans: int, every: int | None) -> list[int]:
    """The numbers of the scans that are left out."""
    series = series_of(np.zeros((scans, 1, 3)))
    keyframes = [Keyframe(scan.points, None) for scan in series.scans]
    rest, _, held_out = hold_out(series, keyframes, every)
    assert len(rest.scans) + len(held_out) == scans
    return [int(scan.time) for scan in held_out]


def test_every_second_scan_is_left_out_as_in_the_paper():
    assert left_out(9, 2) == [1, 3, 5, 7]
    assert left_out(10, 2) == [1, 3, 5, 7]
    assert left_out(9, 3) == [2, 5]
    assert left_out(9, None) == []


@given(st.integers(2, 200), st.integers(2, 20))
def test_the_first_and_the_last_scan_always_stay(scans, every):
    if every >= scans:
        with pytest.raises(InputError, match="leaves none of the"):
            left_out(scans, every)
        return
    numbers = left_out(scans, every)
    assert {0, scans - 1}.isdisjoint(numbers)
    assert set(numbers) == {k for k in range(scans - 1) if (k + 1) % every == 0}


@pytest.fixture
def shifted(tmp_path) -> Path:
    """A leaf that shifts by 1 a day on days 0, 1 and 4."""
    folder = tmp_path / "shifted"
    folder.mkdir()
    leaf = np.random.default_rng(0).random((400, 3)) * [10, 2, 1]
    for day in (0, 1, 4):
        np.savetxt(folder / f"day{day}.xyz", leaf + np.array([0, 0, day]), fmt="%.6f")
    return folder


WHOLE = replace(PLAIN, transport="whole", holdout=2)


def test_an_even_shift_is_reconstructed_at_the_scans_time(shifted):
    clip, _ = bake_with_survey([shifted], WHOLE)
    (error,) = verify(clip)
    assert (error.name, error.date, error.points) == ("day1.xyz", "day 1", 400)
    for distances in error.distances:
        assert distances.maximum < 1e-3  # at another time than day 1: 0.5


def test_distances_are_those_to_the_nearest_point(shifted):
    far = np.loadtxt(shifted / "day1.xyz")
    np.savetxt(shifted / "day1.xyz", np.vstack([far, [[30.0, 1.0, 1.5]]]), fmt="%.6f")
    clip, _ = bake_with_survey([shifted], WHOLE)
    (error,) = verify(clip)
    assert error.distances[0].maximum < 1e-3, "nothing was made up"
    real = np.loadtxt(shifted / "day1.xyz")
    missed = cKDTree(clip.at(1.0).positions).query(real)[0]
    distances = error.distances[1]
    assert distances.maximum == pytest.approx(missed.max(), rel=1e-4)
    assert distances.mean == pytest.approx(missed.mean(), rel=1e-3)
    assert distances.deviation == pytest.approx(missed.std(), rel=1e-3)


def test_figures_are_in_the_unit_of_the_scans(write_scans):
    folder = write_scans(days=(0, 1, 2))
    large = folder.with_name("large")
    large.mkdir()
    for path in folder.iterdir():
        np.savetxt(large / path.name, np.loadtxt(path) * [1000, 1000, 1000, 1], fmt="%.4f")
    options = replace(PLAIN, holdout=2)
    errors = [verify(bake_with_survey([f], options)[0])[0] for f in (folder, large)]
    small, big = (error.distances[0] for error in errors)
    assert small.mean > 1e-2
    assert big.mean == pytest.approx(1000 * small.mean, rel=1e-2)


def test_scans_left_out_play_no_part_in_the_bake(write_scans):
    folder = write_scans(days=(0, 1, 2, 3, 4))
    clip, record = bake_with_survey([folder], replace(PLAIN, holdout=2))
    kept = [folder / f"day{day:02d}.txt" for day in (0, 2, 4)]
    alone, _ = bake_with_survey(kept, PLAIN)
    assert alone.held_out == ()
    assert clip.held_out == record.held_out
    assert [scan.name for scan in clip.scans] == [path.name for path in kept]
    assert [(held.name, held.time) for held in record.held_out] == [
        ("day01.txt", 1),
        ("day03.txt", 3),
    ]
    for ours, theirs in zip(clip.intervals, alone.intervals, strict=True):
        assert (ours.start, ours.end) == (theirs.start, theirs.end)
        for a, b in zip(ours.curve, theirs.curve, strict=True):
            assert np.array_equal(a, b)


def test_a_whole_series_has_nothing_to_verify(write_scans):
    clip, _ = bake_with_survey([write_scans()], PLAIN)
    assert verify(clip) == []


def test_all_together(write_scans):
    clip, _ = bake_with_survey([write_scans(days=range(5))], replace(PLAIN, holdout=2))
    errors = verify(clip)
    made, missed = overall(errors)
    assert made.mean == pytest.approx(np.mean([e.distances[0].mean for e in errors]))
    assert missed.maximum == max(e.distances[1].maximum for e in errors)


@pytest.mark.parametrize(("every", "words"), [(2, "leaves none of the 2"), (1, "at least 2")])
def test_what_cannot_be_left_out(write_scans, every, words):
    with pytest.raises(InputError, match=words):
        bake_with_survey([write_scans(days=(0, 1))], replace(PLAIN, holdout=every))
