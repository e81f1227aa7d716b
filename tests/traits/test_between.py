"""Traits in between: no jump at a scan, as near to truth as at scans; what is unsure says so."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from baker import Options, bake
from baker.interpolation.packing import Movers, pack_interval
from gclip import Clip, Motion, ScanMark, Track
from grow import plant
from grow.series import Plan, write_series
from traits import measure, organs

KNOWN = ("length", "area", "angle")


@pytest.fixture(scope="module")
def grown(tmp_path_factory: pytest.TempPathFactory) -> Clip:
    folder = tmp_path_factory.mktemp("maize") / "scans"
    write_series(Plan("maize", seed=1, scans=3, days=6, points=(3000, 6000)), folder)
    return bake([folder], Options(align="none", up="z", unit="mm", workers=1))


def test_nothing_jumps_at_a_scan(grown: Clip) -> None:
    day = grown.times[1]
    just = [{one.track: one for one in measure(grown, day + off)} for off in (-1e-5, 0.0, 1e-5)]
    for track, at in just[1].items():
        for near in (just[0].get(track), just[2][track]):
            if near is None:  # a bud, until this scan
                continue
            if at.points >= 100:
                assert near.height == pytest.approx(at.height, rel=0.01)
                assert near.hull == pytest.approx(at.hull, rel=0.04)
                assert near.area == pytest.approx(at.area, rel=0.02)
                if track is not None:
                    assert near.length == pytest.approx(at.length, rel=0.02)
                    assert near.angle == pytest.approx(at.angle, abs=1.0)


def test_two_samples_share_the_points_of_one(grown: Clip, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(organs, "MAX_POINTS", 200)
    day = 0.75 * grown.times[0] + 0.25 * grown.times[1]
    most = [
        max(len(one.points) for one in sample.organs.values())
        for sample in organs.samples_at(grown, day)
    ]
    assert most == [150, 50]


def test_between_scans_sure_traits_are_true(grown: Clip) -> None:
    subject, off = plant("maize", 1), []
    for before, after in zip(grown.times, grown.times[1:], strict=False):
        day = (before + after) / 2
        true_organs = subject.organs(day)
        truth = {f"leaf {o.label}" if o.label else "stem": o for o in true_organs}
        for one in measure(grown, day)[1:]:
            true = truth[grown.track_table[one.track].name]
            if "area" in one.sure:
                off.append([one.length / true.length - 1.0, one.area / true.area - 1.0])
    lengths, areas = np.abs(off).T
    assert len(off) >= 6
    # A leaf that two of three scans show, and that doubles in between, is farthest off.
    assert lengths.mean() < 0.025
    assert areas.mean() < 0.03
    assert max(lengths.max(), areas.max()) < 0.1


def test_a_leaf_that_stands_still_keeps_its_area(tmp_path: Path) -> None:
    """Half-way from one scan to another lie points that were on the border a little inside."""
    found = []
    for day in (0, 1):
        rng = np.random.default_rng(day)
        turn, up = rng.uniform(0, 2 * np.pi, 300), rng.uniform(0, 60, 300)
        stem = np.column_stack([5 * np.cos(turn), 5 * np.sin(turn), up])
        x, y = rng.uniform(0, 100, 1500), rng.uniform(-10, 10, 1500)
        leaf = np.column_stack([5 + x, y, 50 + 20 * np.sin(x / 60)])
        rows = np.column_stack([np.r_[stem, leaf], np.r_[np.zeros(300), np.ones(1500)]])
        np.savetxt(tmp_path / f"day{day}.txt", rows)
    clip = bake([tmp_path], Options(align="none", up="z", labels="consistent", workers=1))
    for day in (0.0, 0.5, 1.0):
        found += [one.area for one in measure(clip, day) if one.track == 1]
    assert found[1] == pytest.approx((found[0] + found[2]) / 2, rel=0.02)


def test_a_base_is_a_rim_and_a_short_thick_stem_stands_upright() -> None:
    rng = np.random.default_rng(0)
    turn, up = rng.uniform(0, 2 * np.pi, 1200), 60 * (1 - np.sqrt(1 - rng.uniform(0, 1, 1200)))
    radius = 5 * (1 - up / 60)
    stem = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), up])
    whole, one = measure(_still(stem, np.zeros(1200, int)), 0.0)
    assert one.angle < 3.0
    assert one.length == pytest.approx(60.0, rel=0.05)
    assert one.area == pytest.approx(np.pi * 5 * np.hypot(5, 60), rel=0.04)
    assert one.sure == {"height", "length", "area", "hull", "angle"}
    assert whole.sure >= {"area"}


def test_few_points_tell_no_area_and_say_so() -> None:
    rng = np.random.default_rng(0)
    strip = rng.uniform(0, 1, (150, 3)) * [400.0, 6.0, 0.0]
    coarse = measure(_still(strip, np.zeros(150, int)), 0.0)[1]
    assert "area" not in coarse.sure
    few = measure(_still(strip[:60], np.zeros(60, int)), 0.0)[1]
    assert few.sure == {"height"}


def _still(points: np.ndarray, tracks: np.ndarray) -> Clip:
    movers = Movers(Motion.MOVE, (points, points), tracks)
    return Clip(
        scans=(ScanMark("a", 0.0, "a", len(points)), ScanMark("b", 1.0, "b", len(points))),
        intervals=(pack_interval(0.0, 1.0, [movers], spacing=0.01),),
        track_table=(Track(0, "stem", (1, 2, 3)),),
    )
