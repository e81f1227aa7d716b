"""Movers are spread by area, and the scans stay what they are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from baker import Options, bake
from baker.interpolation.movers import OrganMovers, mid_area
from baker.interpolation.resampling import (
    MAX_OVERHANG,
    position_at,
    with_even_density,
)
from gclip import Motion
from gclip.pack import Movers, elevate_degree


def task(start, end, area=1.0, track=0, motion=Motion.MOVE):
    movers = Movers(motion, (start, end), np.full(len(start), track))
    if area is None:
        return OrganMovers(movers, None)
    points = np.arange(len(start))
    return OrganMovers(movers, None, np.full(len(start), area), points, points)


def sheet(count, width, seed=0):
    points = np.random.default_rng(seed).random((count, 3)) * [width, 1.0, 0.0]
    return points.astype(np.float32)


@pytest.fixture
def stem_and_leaf():
    """A stem that stays, and a leaf as dense as the stem that grows to nine times its length."""
    stem, leaf = sheet(900, 1.0), sheet(300, 1 / 3, seed=1)
    grown = leaf * np.float32([9, 1, 1]) + [2, 0, 0]
    return [task(stem, stem), task(leaf, grown, 4.0, track=1)]


def test_sparse_organs_gain_movers_in_proportion_to_their_area(stem_and_leaf):
    stem, leaf = with_even_density(stem_and_leaf, growth=2.0)
    assert len(stem) == 900
    assert len(leaf) == pytest.approx(1200, abs=2)


def test_no_more_movers_than_allowed(stem_and_leaf):
    filled = with_even_density(stem_and_leaf, growth=0.25)
    assert sum(map(len, filled)) == pytest.approx(1200 + 300, abs=2)


def test_added_movers_share_the_ends_of_another_and_leave_it_between(stem_and_leaf):
    leaf = with_even_density(stem_and_leaf, growth=2.0)[1]
    start, _, end = leaf.curve
    ends = {(*a, *b) for a, b in zip(start.tolist(), end.tolist(), strict=True)}
    assert len(ends) == 300
    assert len(np.unique(position_at(leaf.curve, 0.5), axis=0)) == len(leaf)


def test_lost_organs_are_left_as_they_are():
    fallen = task(sheet(50, 1.0), sheet(50, 1.0), area=None, motion=Motion.FALL)
    assert with_even_density([fallen], growth=1.0) == [fallen.movers]


def test_even_movers_stay_as_they_are(stem_and_leaf):
    even = [replace(one, area=np.ones(len(one.movers))) for one in stem_and_leaf]
    filled = with_even_density(even, growth=1.0)
    assert [len(own) for own in filled] == [900, 300]


def test_movers_that_share_a_point_share_its_area():
    area = mid_area(np.full(2, 4.0), np.array([0, 0]), np.full(2, 2.0), np.arange(2))
    assert area == pytest.approx([2.0, 2.0])


def test_movers_of_one_point_spread_out_from_their_mean():
    """An addition goes on from its mover as far as that is from the mean, and no farther."""
    count = 24
    along = np.linspace(0.0, 2.0, count)
    start = np.zeros((count, 3))
    end = np.column_stack([along, np.zeros((count, 2))])
    movers = Movers(Motion.MOVE, (start, end), np.zeros(count, int))
    task = OrganMovers(movers, None, np.ones(count), np.zeros(count, int), np.arange(count))
    (filled,) = with_even_density([replace(task, area=np.r_[np.ones(6), 9 * np.ones(18)])], 1.0)
    assert len(filled) > count
    middle = position_at(filled.curve, 0.5)
    assert np.abs(middle[:count, 0] - 0.5).max() == 0.5
    assert 0.5 < np.abs(middle[:, 0] - 0.5).max() <= 1.0 + 1e-12
    assert np.abs(middle[:, 1:]).max() == 0.0


def test_no_addition_runs_far_ahead_of_a_tip():
    """No farther than half the distance to the next mover: beyond a tip that nothing follows."""
    count = 24
    end = np.column_stack([np.linspace(0.0, 2.0, count), np.zeros((count, 2))])
    movers = Movers(Motion.MOVE, (np.zeros((count, 3)), end), np.zeros(count, int))
    area = np.r_[np.ones(6), 9 * np.ones(18)]
    ends = np.zeros(count, int), np.arange(count)
    task = OrganMovers(movers, None, area / 100, *ends)
    (filled,) = with_even_density([task], 1.0)
    assert len(filled) > count
    assert position_at(filled.curve, 0.5)[:, 0].max() <= 1.0 + MAX_OVERHANG * 0.3 + 1e-12


def test_additions_of_what_is_born_stay_with_it(tmp_path):
    """Half-way a new twig whose points are sparse at its tip ends where its own movers do."""
    rng = np.random.default_rng(4)
    up, out = np.linspace(0.0, 8.0, 2000)[:, None], 8.0 * np.linspace(0.0, 1.0, 40)[:, None] ** 2
    stem = rng.normal(0.0, 0.05, (2000, 3)) + up * [0.0, 0.0, 1.0]
    twig = rng.normal(0.0, 0.1, (40, 3)) + out * [1.0, 0.0, 0.0] + np.array([0.1, 0.0, 6.0])
    labels = np.repeat([0, 1], [2000, 40])
    np.savetxt(tmp_path / "day0.txt", np.c_[stem, labels[:2000]])
    np.savetxt(tmp_path / "day1.txt", np.c_[np.concatenate([stem, twig]), labels])
    tips = []
    for even in (0.0, 1.0):
        options = Options(align="none", up="z", labels="consistent", even=even, workers=1)
        tips.append(float(bake([tmp_path], options).at(0.5).positions[:, 0].max()))
    assert tips[0] > 3.5
    assert tips[1] == pytest.approx(tips[0], abs=0.1)


def test_a_bud_has_no_area():
    whole = mid_area(np.ones(3), np.arange(3), np.ones(3), np.arange(3))
    born = mid_area(np.ones(3), np.arange(3), np.ones(3), np.arange(3), born=True)
    assert born == pytest.approx(whole / 4)


@pytest.mark.parametrize("degree", [2, 3])
def test_raised_curves_are_the_same_curves(degree):
    curve = (np.float32([[0, 0, 0]]), np.float32([[2, 4, 6]]))
    assert position_at(elevate_degree(curve, degree), 0.5) == pytest.approx(position_at(curve, 0.5))
    assert position_at(elevate_degree(elevate_degree(curve, 2), 3), 0.5) == pytest.approx(
        position_at(curve, 0.5)
    )


@pytest.mark.parametrize("even", [0.0, 1.0])
def test_scans_are_kept_whatever_is_added(tmp_path, even):
    leaf = sheet(200, 1.0)
    for day, stretch in enumerate((1.0, 4.0)):
        points = np.concatenate([sheet(300, 0.2) * [1, 1, 1] - [0.2, 0, 0], leaf * [stretch, 1, 1]])
        labels = np.repeat([0, 1], [300, 200])
        np.savetxt(tmp_path / f"day{day}.txt", np.c_[points, labels], fmt="%.6f %.6f %.6f %d")
    clip = bake([tmp_path], Options(align="none", even=even))
    for day in (0, 1):
        scan = np.loadtxt(tmp_path / f"day{day}.txt")[:, :3]
        found = np.unique(np.round(clip.at(day).positions, 3), axis=0)
        assert len(found) == pytest.approx(len(np.unique(np.round(scan, 3), axis=0)), rel=0.01)
    assert (len(clip.intervals[0]) > 800) == (even > 0)
