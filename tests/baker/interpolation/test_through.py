"""Smooth paths: one velocity on both sides of a scan, no overshoot, real times honoured."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from baker import Options, bake
from grow import plant

FIXED = {"align": "none", "up": "z", "labels": "consistent", "even": 0.0}


def write(folder, times, place):
    """A sheet of points, moved and stretched by `place` at each time."""
    sheet = np.random.default_rng(0).random((400, 3)) * [4, 1, 0.01]
    for time in times:
        table = np.c_[place(sheet, time), np.zeros(len(sheet))]
        np.savetxt(folder / f"day{time:04.1f}.txt", table, fmt="%.5f %.5f %.5f %d")
    return folder


def positions_about(clip, time, step):
    """Positions of the same tissue shortly before a scan, at it, and shortly after."""
    before, here, after = (clip.at(time + shift).local for shift in (-step, 0.0, step))
    came = clip.at(time - 1e-6 * step).local
    to_here = cKDTree(came).query(here)[1]
    return before[to_here], here, after


def jump(clip, time, step=1e-3):
    """Mean change of velocity at a scan, relative to the mean speed."""
    before, here, after = positions_about(clip, time, step)
    arriving, leaving = (here - before) / step, (after - here) / step
    speed = np.linalg.norm(arriving, axis=1).mean() + np.linalg.norm(leaving, axis=1).mean()
    return 2 * np.linalg.norm(leaving - arriving, axis=1).mean() / speed


def test_velocity_is_continuous_at_scans(tmp_path):
    folder = write(tmp_path, (0, 1, 3), lambda sheet, t: sheet * [1, 1, 1] + [0, 0, t**1.5])
    plain, smooth = (
        bake([folder], Options(paths=p, precision="float32", **FIXED))
        for p in ("straight", "smooth")
    )
    assert {interval.degree for interval in smooth.intervals} == {3}
    assert jump(smooth, 1.0) < 0.05 < 0.2 < jump(plain, 1.0)


def test_even_motion_over_uneven_times_stays_even(tmp_path):
    folder = write(tmp_path, (0, 1, 4), lambda sheet, t: sheet + np.array([0, 0, t]))
    clip = bake([folder], Options(paths="smooth", precision="float32", **FIXED))
    for time in np.linspace(0, 4, 17):
        assert clip.at(time).local[:, 2].mean() == pytest.approx(time, abs=0.02)


def test_what_turns_back_does_not_overshoot(tmp_path):
    heights = {0.0: 0.0, 1.0: 2.0, 2.0: 1.0, 3.0: 1.0}
    folder = write(tmp_path, heights, lambda sheet, t: sheet + np.array([0, 0, heights[t]]))
    clip = bake([folder], Options(paths="smooth", precision="float32", **FIXED))
    course = [clip.at(time).local[:, 2].mean() for time in np.linspace(0, 3, 61)]
    assert max(course) <= 2.02
    assert min(course[20:]) >= 0.98


def test_growing_leaves_never_shorten(tmp_path):
    maize = plant("maize", 2)
    for day in (4.0, 5.0, 7.0, 8.0):
        cloud = maize.cloud(day, points=2500)
        table = np.c_[cloud.points, cloud.labels]
        np.savetxt(tmp_path / f"day{day:02.0f}.txt", table, fmt="%.4f %.4f %.4f %d")
    clip = bake([tmp_path], Options(paths="smooth", **FIXED))
    heights = [np.quantile(clip.at(t).local[:, 2], 0.99) for t in np.linspace(4, 8, 41)]
    assert np.diff(heights).min() > -0.01 * max(heights)


def test_scans_are_still_met_exactly(tmp_path):
    folder = write(tmp_path, (0, 1, 3), lambda sheet, t: sheet * [1 + t, 1, 1])
    clip = bake([folder], Options(paths="smooth", **FIXED))
    for time in (0, 1, 3):
        scan = np.loadtxt(folder / f"day{time:04.1f}.txt")[:, :3]
        assert cKDTree(scan).query(clip.at(time).positions)[0].max() < 1e-3
