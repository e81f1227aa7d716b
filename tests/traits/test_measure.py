"""Traits against plants whose every measure is known, and against plain shapes."""

from __future__ import annotations

import csv
import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from baker import Options, bake
from baker.interpolation.packing import Movers, pack_interval
from gclip import Clip, Motion, ScanMark, Track
from grow import plant
from grow.series import Plan, write_series
from traits import measure, measure_days, write_table
from traits.axis import Axis, axis_of
from traits.neighbors import nearest_neighbors
from traits.smooth import fit_patches, noise_of, smoothed
from traits.surface import Surface, surface_of
from traits.table import COLUMNS, NamedPlant
from traits.traits import _hull

UP = np.array([0.0, 0.0, 1.0])


def found_surface(points: np.ndarray) -> Surface:
    return surface_of(points, nearest_neighbors(points))


def found_axis(points: np.ndarray, parent: np.ndarray) -> Axis | None:
    return axis_of(points, nearest_neighbors(points), parent, UP)


def called(label: int) -> str:
    """The track of a grown plant's organ."""
    return f"leaf {label}" if label else "stem"


@pytest.mark.parametrize("count", [150, 600, 2500])
def test_area_of_a_rectangle_a_strip_and_a_tube(count: int) -> None:
    rng = np.random.default_rng(count)
    u, v = rng.uniform(size=(2, count))
    flat = np.zeros(count)
    shapes = [
        np.column_stack([40 * u, 60 * v, flat]),
        np.column_stack([240 * u, 10 * v, flat]),
        np.column_stack(
            [10 * np.cos(2 * np.pi * u), 10 * np.sin(2 * np.pi * u), 2400 / (20 * np.pi) * v]
        ),
    ]
    for points in shapes:
        # A few hundred random points tell an area to some per cent, no better; a strip two of
        # their distances wide is hardly seen as one.
        assert found_surface(points).area == pytest.approx(
            2400, rel=max(0.04, 2.2 / np.sqrt(count))
        )
        assert found_surface(7 * points).area == pytest.approx(49 * found_surface(points).area)


@pytest.mark.parametrize("count", [300, 600, 2500])
def test_area_of_evenly_spread_points(count: int) -> None:
    """As scanners' points are: quasi-random (Roberts 2018), and those kept from points too many."""
    ratio = 1.32471795724474602596
    u, v = (0.3 + np.arange(count)[:, None] / [ratio, ratio**2]).T % 1.0
    leaf = np.column_stack([40 * u, 60 * v, np.zeros(count)])
    stem = np.column_stack(
        [10 * np.cos(2 * np.pi * u), 10 * np.sin(2 * np.pi * u), 2400 / (20 * np.pi) * v]
    )
    for points in (leaf, stem):
        assert found_surface(points).area == pytest.approx(2400, rel=0.03)


def test_smoothing_takes_noise_away_and_leaves_a_stem_its_radius() -> None:
    rng = np.random.default_rng(0)
    turn, height = rng.uniform(0, 2 * np.pi, 1500), rng.uniform(0, 100, 1500)
    stem = np.column_stack([8 * np.cos(turn), 8 * np.sin(turn), height])
    noisy = stem + rng.normal(0, 0.4, stem.shape)
    inner = (height > 5) & (height < 95)
    smooth = smoothed(fit_patches(noisy, noisy), 0.4).points
    before, after = (np.hypot(p[inner, 0], p[inner, 1]) for p in (noisy, smooth))
    assert after.mean() == pytest.approx(8.0, rel=0.02)
    assert after.std() < 0.6 * before.std()
    assert noise_of({0: fit_patches(noisy, noisy)}).plant == pytest.approx(0.4, rel=0.1)
    assert noise_of({0: fit_patches(stem, stem)}).plant < 0.04


def test_the_axis_of_a_bent_strip_starts_at_its_parent_and_ends_at_its_tip() -> None:
    rng = np.random.default_rng(1)
    angle, across = rng.uniform(0, np.pi / 2, 900), rng.uniform(-6, 6, 900)
    leaf = np.column_stack([60 - 60 * np.cos(angle), across, 60 * np.sin(angle)])
    parent = np.column_stack([np.zeros(50), np.zeros(50), np.linspace(-50, 0, 50)])
    axis = found_axis(leaf, parent)
    assert axis is not None
    assert axis.length == pytest.approx(30 * np.pi, rel=0.02)
    assert np.linalg.norm(axis.line[0]) < 4
    assert np.linalg.norm(axis.line[-1] - [60, 0, 60]) < 4
    # The chord to a quarter of a quarter circle leans by an eighth of a right angle.
    assert axis.angle(UP) == pytest.approx(90 / 8, abs=3)


@pytest.fixture(scope="module")
def grown(tmp_path_factory: pytest.TempPathFactory) -> Clip:
    folder = tmp_path_factory.mktemp("maize") / "scans"
    write_series(Plan("maize", seed=0, scans=3, days=14), folder)
    return bake([folder], Options(align="none", unit="mm", workers=1))


def test_traits_of_a_grown_maize_are_true(grown: Clip) -> None:
    known = plant("maize", 0)
    errors = []
    for day in grown.times:
        truth = {called(organ.label): organ for organ in known.organs(day)}
        whole, *organs = measure(grown, day)
        assert whole.area == pytest.approx(sum(o.area for o in truth.values()), rel=0.05)
        # The truth of a height is where axes end; leaves arch and have thickness.
        tops = known.cloud(day, 40_000, noise=0).points[:, 2]
        assert whole.height == pytest.approx(tops.max(), rel=0.05)
        for organ in organs:
            if organ.points >= 120:
                true = truth[grown.track_table[organ.track].name]
                errors.append([organ.length / true.length - 1, organ.area / true.area - 1])
    lengths, areas = np.abs(errors).T
    assert len(errors) > 12
    assert np.median(lengths) < 0.02
    assert np.quantile(lengths, 0.9) < 0.05
    assert np.median(areas) < 0.05
    assert areas.max() < 0.15


def test_compound_leaves_are_as_long_as_they_are(tmp_path: Path) -> None:
    plan = Plan("tomato", seed=0, scans=2, points=(3000, 9000))
    write_series(plan, tmp_path / "scans")
    straight = Options(align="none", up="z", paths="straight", unit="mm", workers=1)
    clip = bake([tmp_path / "scans"], straight)
    known, errors, sure = plant("tomato", 0), [], []
    for day in clip.times:
        truth = {called(organ.label): organ for organ in known.organs(day)}
        cloud = known.cloud(day, 60_000, noise=0)
        for organ in measure(clip, day)[1:]:
            true = truth[clip.track_table[organ.track].name]
            hull = ConvexHull(cloud.points[cloud.labels == true.label]).volume
            if organ.points >= 500:
                errors.append(
                    [organ.length / true.length, organ.area / true.area, organ.hull / hull]
                )
            if "hull" in organ.sure:
                sure.append(abs(organ.hull / hull - 1.0))
    length, area_, hull = np.abs(np.array(errors) - 1.0).T
    assert len(errors) > 6
    assert length.max() < 0.05
    assert np.median(area_) < 0.03
    assert np.quantile(area_, 0.9) < 0.05
    assert np.median(hull) < 0.05
    assert len(sure) > 4
    assert np.quantile(sure, 0.9) < 0.05


@pytest.mark.parametrize("count", [60, 400, 2500])
def test_a_hull_is_that_of_the_surface(count: int) -> None:
    turn = np.random.default_rng(count).normal(size=(count, 3))
    ball = 7.0 * turn / np.linalg.norm(turn, axis=1, keepdims=True)
    assert _hull(ball).volume == pytest.approx(4 / 3 * np.pi * 343.0, rel=0.05)
    assert _hull(ball * [1, 1, 0]) == (None, False)


def test_hulls_that_points_can_not_tell_are_not_sure(grown: Clip) -> None:
    """A leaf's area may be: thin leaves of few points lack much of their hull."""
    known, thin = plant("maize", 0), 0
    for day in grown.times:
        cloud = known.cloud(day, 60_000, noise=0)
        for organ in measure(grown, day)[1:]:
            label = int(
                grown.track_table[organ.track].name.removeprefix("leaf ").replace("stem", "0")
            )
            if "area" in organ.sure and "hull" not in organ.sure:
                thin += 1
            if "hull" in organ.sure:
                hull = ConvexHull(cloud.points[cloud.labels == label]).volume
                assert organ.hull == pytest.approx(hull, rel=0.08)
    assert thin > 4


def test_organs_are_measured_from_birth_to_loss(grown: Clip) -> None:
    for day in measure_days(grown):
        seen = {one.track for one in measure(grown, day)} - {None}
        for track in grown.track_table:
            alive = track.born <= day and (track.lost is None or day < track.lost)
            if day in grown.times:
                assert (track.id in seen) == alive


def rows_of(clip: Clip, days: list[float], plant: str = "p1") -> list[dict[str, str]]:
    text = io.StringIO()
    write_table(text, NamedPlant(clip, plant), days)
    return list(csv.DictReader(io.StringIO(text.getvalue())))


def test_the_table_is_long_and_says_where_values_come_from(grown: Clip) -> None:
    rows = rows_of(grown, measure_days(grown))
    assert tuple(rows[0]) == COLUMNS
    stem = [r for r in rows if r["organ"] == "stem" and r["trait"] == "length"]
    assert [r["state"] for r in stem] == ["scan", "between", "scan", "between", "scan"]
    assert [float(r["time"]) for r in stem] == measure_days(grown)
    growth = [r for r in rows if r["organ"] == "stem" and r["trait"] == "length_growth"]
    assert len(growth) == 2
    at = {float(r["time"]): float(r["value"]) for r in stem}
    for row in growth:
        start, end = float(row["start"]), float(row["end"])
        assert float(row["elapsed"]) == end - start
        assert float(row["value"]) == pytest.approx((at[end] - at[start]) / (end - start), rel=1e-4)
        assert row["unit"] == "mm/day"
    assert {r["level"] for r in rows} == {"plant", "organ"}
    assert {r["unit"] for r in rows if r["trait"] == "area"} == {"mm^2"}
    assert all(r["clip_digest"].startswith("sha256:") and r["method"] for r in rows)


def test_cells_are_no_formulas() -> None:
    points = np.random.default_rng(0).uniform(0, 1, (40, 3))
    movers = Movers(Motion.MOVE, (points, points + 1), np.zeros(40, int))
    clip = Clip(
        scans=(ScanMark("a", 0.0, "=1+1", 40), ScanMark("b", 1.0, "-2+3", 40)),
        intervals=(pack_interval(0.0, 1.0, [movers], spacing=0.1),),
        track_table=(Track(0, '=HYPERLINK("x")', (1, 2, 3), kind="@root"),),
    )
    rows = rows_of(clip, [0.0, 1.0], plant="+cmd|' /C calc'!A0")
    for row in rows:
        for cell in row.values():
            if cell[:1] in set("=+-@"):
                float(cell)
    assert rows[-1]["organ"] == '\'=HYPERLINK("x")'


def test_a_point_or_two_are_no_organ(grown: Clip) -> None:
    few = replace(grown.intervals[0], tracks=grown.intervals[0].tracks.copy())
    few.tracks[:2] = 1
    assert measure(replace(grown, intervals=(few, *grown.intervals[1:])), 0.0)
    assert found_axis(np.zeros((3, 3)), np.zeros((0, 3))) is None
    assert found_axis(np.zeros((20, 3)), np.zeros((0, 3))) is None
    assert found_surface(np.zeros((20, 3))).area == 0.0
