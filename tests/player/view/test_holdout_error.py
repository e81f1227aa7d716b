"""Errors against scans that were left out: as distances, as colours, in pictures and files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import moderngl
import numpy as np
import pytest
from plyfile import PlyData
from scipy.spatial import cKDTree

from gclip import Clip, ScanMark
from player.cli import main as play
from player.errors import PlayerError
from player.export import Film, export
from player.ui import keys
from player.view.camera import Camera
from player.view.choices import Compare
from player.view.colors import UNKNOWN_COLOR, Colors, ValueRange
from player.view.playback import Timeline
from player.view.split_view import Pane, panes_of
from player.view.state import Scene
from player.view.style import ColorMode, Style
from player.window.dynamic_resolution import Detail
from player.window.viewports import Viewports
from tests.player.drawn import window_pixels
from traits.holdout_error import holdout_errors

ERROR = Style(color_by="error")
DAY = 1.0


@pytest.fixture
def clip(make_clip: Any) -> Clip:
    """Its scan of day 1 was left out; there the upper half of the plant stands 3 farther back."""
    clip = make_clip(colors=((9, 9, 9, 255), (9, 9, 9, 255)))
    real = clip.at(DAY).local.copy()
    real[real[:, 2] > 25.0, 1] += 3.0
    return replace(clip, held_out=(ScanMark("b.ply", DAY, "day 1", len(real), real),))


def test_a_mover_s_error_is_its_distance_to_the_scan(clip: Clip) -> None:
    errors = holdout_errors(clip)[0]
    frame = clip.at(DAY)
    nearest = cKDTree(clip.held_out[0].positions).query(frame.local)[0]
    assert errors == pytest.approx(nearest, abs=1e-5)
    low = frame.local[:, 2] < 24.0
    assert errors[low].max() < 0.1
    assert np.median(errors[~low & (frame.local[:, 2] > 28.0)]) == pytest.approx(3.0, abs=0.1)


def test_what_is_no_part_of_the_plant_has_no_error(make_clip: Any) -> None:
    clip = make_clip(lost="remove")
    real = ScanMark("x.ply", 4.0, positions=clip.at(4.0).local)
    errors = holdout_errors(replace(clip, held_out=(real,)))[1]
    assert np.isnan(errors[clip.intervals[1].groups[0].stop :]).all()
    assert np.isfinite(errors[: clip.intervals[1].groups[0].stop]).all()


def test_errors_are_the_colors_of_a_copy(clip: Clip) -> None:
    worn, scale = Colors(clip).clip_with_colors(ERROR), Colors(clip).value_range(ERROR)
    assert scale is not None
    assert (scale.low, scale.high, scale.unit) == (0.0, 3.0, "mm")
    errors = holdout_errors(clip)[0]
    painted, ramp = worn.at(DAY).colors[:, :3].astype(int), scale.colors().astype(int)
    assert np.abs(painted[errors < 0.005] - ramp[0]).max() <= 2
    assert np.abs(painted[errors >= 3.0] - ramp[-1]).max() <= 1
    assert (worn.at(3.0).colors[:, :3] == UNKNOWN_COLOR).all(), "nothing is known of that interval"
    assert Colors(clip).clip_with_colors(Style()) is clip


def test_an_error_s_place_on_the_ramp_is_its_share_of_the_highest(clip: Clip) -> None:
    known = holdout_errors(clip)[0]
    for highest in (3.0, 12.0):
        scale = ValueRange(high=highest, unit="mm", color_map="gray")
        shades = scale.colored(clip.intervals[0], known).start_colors[:, 0].astype(int)
        assert np.abs(shades - 255 * np.minimum(known / highest, 1.0)).max() <= 1


def test_the_window_s_stage_shows_errors_and_goes_back(
    context: moderngl.Context, clip: Clip
) -> None:
    stage, size = Viewports(context, [clip]), (160, 120)
    pane = Pane(0, DAY, Camera.home(clip, 4 / 3))

    def picture(style: Style) -> np.ndarray:
        stage.draw(size, [pane], style, Detail(), None)
        return window_pixels(context, stage, size)

    before, errors, after = (picture(style) for style in (Style(), ERROR, Style()))
    stage.release()
    assert np.array_equal(before, after)
    yellow = (errors[..., 0] > 150) & (errors[..., 1] > 150) & (errors[..., 2] < 120)
    assert yellow[60:].sum() > 100, "the upper half is wrong; rows go up"
    assert yellow[:45].sum() == 0


def test_a_scan_left_out_is_compared_with_where_it_is_nearest(clip: Clip) -> None:
    camera = Camera.home(clip, 4 / 3)
    scene = Scene(Timeline.of(clip.times), camera, camera, Style(), (clip,), compare=Compare.BESIDE)
    seen = {}
    for day in (0.2, 1.2, 1.8):
        left, right = panes_of(scene.with_timeline(lambda t, day=day: t.at(day)), ["p"])
        assert (right.day, right.held_out_index) == (day, None)
        seen[day] = (left.day, left.held_out_index, left.caption)
    assert seen[0.2] == (0.0, None, "Scan of day 0")
    assert seen[1.2] == (1.0, 0, "Left out: scan of day 1")
    assert seen[1.8] == (2.0, None, "Scan of day 2")


def test_a_scan_left_out_is_drawn_as_it_is(context: moderngl.Context, clip: Clip) -> None:
    plain, wrong = (Colors(clip).held_out_clip(0, style) for style in (Style(), ERROR))
    real = clip.held_out[0].positions
    for shown in (plain, wrong):
        assert np.array_equal(shown.at(2.5).local, real)
    assert (plain.at(1.0).colors[:, :3] == 9).all()
    assert set(np.unique(plain.at(1.0).tracks)) == {0, 1}
    missed = cKDTree(clip.at(DAY).local).query(real)[0]
    painted, ramp = wrong.at(1.0).colors[:, :3], Colors(clip).value_range(ERROR).colors()
    assert (painted[missed >= 3.0] == ramp[-1]).all()
    assert np.abs(painted[missed < 0.005].astype(int) - ramp[0]).max() <= 2

    stage, size, camera = Viewports(context, [clip]), (160, 120), Camera.home(clip, 4 / 3)
    pictures = []
    for pane in (Pane(0, DAY, camera), Pane(0, DAY, camera, held_out_index=0)):
        for style in (Style(), ERROR):
            stage.draw(size, [pane], style, Detail(), None)
            pictures.append(window_pixels(context, stage, size).tobytes())
    stage.release()
    assert len(set(pictures)) == 4


def test_files_carry_the_errors_as_colors(clip: Clip, tmp_path: Path) -> None:
    export(clip, Film(at=(DAY,), style=ERROR), tmp_path / "cloud.ply")
    vertices = PlyData.read(tmp_path / "cloud.ply")["vertex"]
    found = np.column_stack([vertices[name] for name in ("red", "green", "blue", "alpha")])
    assert np.array_equal(found, Colors(clip).clip_with_colors(ERROR).at(DAY).colors)


def test_point_files_take_the_organs_colors_and_refuse_what_changes(
    clip: Clip, tmp_path: Path
) -> None:
    film = Film(at=(DAY,), style=Style(color_by="track"))
    export(clip, film, tmp_path / "cloud.ply")
    vertices = PlyData.read(tmp_path / "cloud.ply")["vertex"]
    found = np.column_stack([vertices[name] for name in ("red", "green", "blue", "alpha")])
    assert np.array_equal(found, clip.palette[vertices["scalar_label"].astype(int)])
    for name in ("age", "speed", "height"):
        with pytest.raises(PlayerError, match=f"--color {name} changes"):
            export(clip, Film(style=Style(color_by=name)), tmp_path / "plant.glb")
    assert not (tmp_path / "plant.glb").exists()


def test_a_clip_without_a_scan_left_out_says_how_to_get_one(
    make_clip: Any, tmp_path: Path, capsys: Any
) -> None:
    clip = make_clip()
    clip.save(tmp_path / "p.gclip")
    wish = [str(tmp_path / "p.gclip"), "--color", "error"]
    assert play([*wish, "--export", str(tmp_path / "film.mp4")]) == 2
    assert "bake it with --holdout 2" in capsys.readouterr().err
    assert play(wish) == 2
    assert "bake it with --holdout 2" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["p.gclip"]
    with pytest.raises(PlayerError, match="left out"):
        Colors(clip).value_range(ERROR)
    scene = Scene(Timeline.of([0.0, 2.0]), Camera(), Camera(), Style(), (clip,))
    told = keys.ACTIONS["color"].choose(scene, ColorMode.ERROR)
    assert told.style == scene.style
    assert "bake it with --holdout 2" in told.notice
    held = replace(clip, held_out=(ScanMark("x.ply", 1.0, positions=clip.at(1.0).local),))
    for each, reached in ((clip, False), (held, True)):
        seen, shown = set(), replace(scene, clips=(each,))
        for _ in shown.color_modes:
            shown = keys.ACTIONS["color"].do(shown)
            seen.add(shown.color_mode)
        assert (ColorMode.ERROR in seen) == reached
