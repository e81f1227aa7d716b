"""Movers are spread by area, and the scans stay what they are."""

from __future__ import annotations

import numpy as np
import pytest

from baker import Options, bake
from baker.interpolation.movers import mid_area
from baker.interpolation.packing import Movers, elevate_degree
from baker.interpolation.resampling import MAX_OVERHANG, with_even_density
from gclip import Motion
from gclip.evaluate import bernstein


def middles(curve):
    """The positions at mid-interval."""
    weights = bernstein(len(curve) - 1, 0.5)
    return sum(weight * points for weight, points in zip(weights, curve, strict=True))


def filled(movers, area, growth, start_points=None, end_points=None):
    """The movers and their repetitions, as one."""
    points = np.arange(len(movers))
    groups = (points if group is None else group for group in (start_points, end_points))
    first, *repeated = with_even_density(movers, area, *groups, growth)
    assert first is movers
    for more in repeated:
        curve = zip(elevate_degree(movers.curve, 2), more.curve, strict=True)
        tracks = np.concatenate([movers.tracks, more.tracks])
        movers = Movers(Motion.MOVE, tuple(map(np.concatenate, curve)), tracks)
    return movers


def sheet(count, width, seed=0):
    points = np.random.default_rng(seed).random((count, 3)) * [width, 1.0, 0.0]
    return points.astype(np.float32)


@pytest.fixture
def stem_and_leaf():
    """A stem that stays, and a leaf as dense as the stem that grows to nine times its length."""
    stem, leaf = sheet(900, 1.0), sheet(300, 1 / 3, seed=1)
    grown = leaf * np.float32([9, 1, 1]) + [2, 0, 0]
    curve = np.concatenate([stem, leaf]), np.concatenate([stem, grown], dtype=np.float32)
    return Movers(Motion.MOVE, curve, np.repeat([0, 1], [900, 300])), np.repeat(
        [1.0, 4], [900, 300]
    )


def test_sparse_organs_gain_movers_in_proportion_to_their_area(stem_and_leaf):
    stem, leaf = np.bincount(filled(*stem_and_leaf, growth=2.0).tracks)
    assert stem == 900
    assert leaf == pytest.approx(1200, abs=2)


def test_no_more_movers_than_allowed(stem_and_leaf):
    assert len(filled(*stem_and_leaf, growth=0.25)) == pytest.approx(1200 + 300, abs=2)


def test_added_movers_share_the_ends_of_another_and_leave_it_between(stem_and_leaf):
    movers = filled(*stem_and_leaf, growth=2.0)
    start, _, end = (points[movers.tracks == 1] for points in movers.curve)
    ends = {(*a, *b) for a, b in zip(start.tolist(), end.tolist(), strict=True)}
    assert len(ends) == 300
    assert len(np.unique(middles(movers.curve), axis=0)) == len(movers)


def test_even_movers_stay_as_they_are(stem_and_leaf):
    movers, area = stem_and_leaf
    assert filled(movers, np.ones_like(area), growth=1.0) is movers


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
    area = np.r_[np.ones(6), 9 * np.ones(18)]
    more = filled(movers, area, 1.0, start_points=np.zeros(count, int))
    assert len(more) > count
    middle = middles(more.curve)
    assert np.abs(middle[:count, 0] - 0.5).max() == 0.5
    assert 0.5 < np.abs(middle[:, 0] - 0.5).max() <= 1.0 + 1e-12
    assert np.abs(middle[:, 1:]).max() == 0.0


def test_no_addition_runs_far_ahead_of_a_tip():
    """No farther than half the distance to the next mover: beyond a tip that nothing follows."""
    count = 24
    end = np.column_stack([np.linspace(0.0, 2.0, count), np.zeros((count, 2))])
    movers = Movers(Motion.MOVE, (np.zeros((count, 3)), end), np.zeros(count, int))
    area = np.r_[np.ones(6), 9 * np.ones(18)]
    more = filled(movers, area / 100, 1.0, start_points=np.zeros(count, int))
    assert len(more) > count
    assert middles(more.curve)[:, 0].max() <= 1.0 + MAX_OVERHANG * 0.3 + 1e-12


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
    born = mid_area(np.zeros(3), np.arange(3), np.ones(3), np.arange(3))
    assert born == pytest.approx(whole / 4)


@pytest.mark.parametrize("degree", [2, 3])
def test_raised_curves_are_the_same_curves(degree):
    curve = (np.float32([[0, 0, 0]]), np.float32([[2, 4, 6]]))
    assert middles(elevate_degree(curve, degree)) == pytest.approx(middles(curve))
    assert middles(elevate_degree(elevate_degree(curve, 2), 3)) == pytest.approx(middles(curve))


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
