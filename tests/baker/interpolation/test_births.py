"""New organs unfold from where they are attached."""

from __future__ import annotations

import numpy as np
import pytest

from baker import Options, bake

FIXED = {"align": "none", "up": "z", "labels": "consistent", "even": 0.0}


def write(folder, lengths, points=1000):
    """A stem, and from the second scan on a leaf of these lengths."""
    rng = np.random.default_rng(0)
    stem = rng.random((600, 3)) * [0.2, 0.2, 10]
    for day, length in enumerate(lengths):
        leaf = rng.random((points if length else 0, 3)) * [length, 0.5, 0.1] + [0.2, 0, 8]
        table = np.c_[np.concatenate([stem, leaf]), np.repeat([0, 1], [600, len(leaf)])]
        np.savetxt(folder / f"day{day}.txt", table, fmt="%.5f %.5f %.5f %d")
    return bake([folder], Options(**FIXED))


def reach(clip, day):
    frame = clip.at(day)
    return np.quantile(frame.local[frame.tracks == 1][:, 0], 0.99) - 0.2


def test_half_way_an_organ_has_half_of_its_size(tmp_path):
    assert reach(write(tmp_path, (0, 4, 4.5)), 0.5) == pytest.approx(2, rel=0.1)


def test_it_never_goes_back(tmp_path):
    clip = write(tmp_path, (0, 4, 14))
    lengths = [reach(clip, day) for day in np.linspace(0.01, 2, 40)]
    assert np.diff(lengths).min() > -0.01


def test_straight_paths_stay_straight(tmp_path):
    write(tmp_path, (0, 4, 14))
    clip = bake([tmp_path], Options(paths="straight", **FIXED))
    assert {interval.degree for interval in clip.intervals} == {1}
    assert reach(clip, 0.5) == pytest.approx(2, rel=0.1)
