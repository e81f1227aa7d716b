"""New organs unfold from where they are attached."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from baker import Options, bake
from baker.interpolation.movers import OrganPaths
from baker.transport.correspondences import Correspondences
from baker.transport.tasks import Task

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


@pytest.mark.parametrize("lean", [0.0, 50.0])
def test_an_organ_unfolds_from_the_tissue_that_it_grows_on(tmp_path, lean):
    """Which is the top of the stem, wherever that leans."""
    rng = np.random.default_rng(0)
    stem = np.c_[0.3 * rng.normal(size=(900, 2)), 20 * rng.random(900)]
    leaf = np.c_[6 * rng.random(600), 1.5 * rng.normal(size=600), np.full(600, 20.0)]
    angle = np.radians(lean)
    rotation = [[np.cos(angle), 0, -np.sin(angle)], [0, 1, 0], [np.sin(angle), 0, np.cos(angle)]]
    for day, organs in enumerate(([stem], [stem @ rotation, leaf @ rotation])):
        table = np.c_[
            np.concatenate(organs), np.repeat([0, 1], [900, 600])[: sum(map(len, organs))]
        ]
        np.savetxt(tmp_path / f"day{day}.txt", table, fmt="%.5f %.5f %.5f %d")
    clip = bake([tmp_path], Options(**FIXED))
    bud = clip.at(1e-6)
    assert bud.local[bud.tracks == 1][:, 2].min() > 18.0
    middle = clip.at(0.5)
    on_stem, on_leaf = (middle.local[middle.tracks == track] for track in (0, 1))
    assert cKDTree(on_stem).query(on_leaf)[0].min() < 0.5


def test_no_point_of_a_bud_lies_at_the_tip_of_the_new_organ(tmp_path):
    """Where stray points have the parent's label, in both scans."""
    rng = np.random.default_rng(0)
    stem, strays = rng.random((2000, 3)) * [0.2, 0.2, 10], rng.random((6, 3)) * 0.2 + [4, 0, 8]
    leaf = rng.random((800, 3)) * [4, 0.5, 0.1] + [0.2, 0, 8]
    for day, organs in enumerate(([stem, strays], [stem, strays, leaf])):
        labels = np.repeat([0, 1], [2006, 800])[: sum(map(len, organs))]
        table = np.c_[np.concatenate(organs), labels]
        np.savetxt(tmp_path / f"day{day}.txt", table, fmt="%.5f %.5f %.5f %d")
    bud = bake([tmp_path], Options(**FIXED)).at(1e-6)
    assert bud.local[bud.tracks == 1][:, 0].max() < 1.0


def test_a_bud_is_in_one_place_though_movers_that_end_there_start_apart():
    points = np.random.default_rng(0).random((300, 3)) * [1, 1, 30]
    task = Task("match", 0, np.arange(300), np.arange(300))
    by_height, ends = np.argsort(points[:, 2]), np.arange(300)
    contact = by_height[:20]
    ends[by_height[[0, -1]]] = ends[by_height[[-1, 0]]]  # one of the movers that end in the contact
    plan = Correspondences(np.arange(300), ends, 0.0, 0.0, "exact")
    bud = OrganPaths(task, plan).bud(contact, points)
    assert len(bud) == 20
    assert np.ptp(points[bud], axis=0).max() < 5.0
