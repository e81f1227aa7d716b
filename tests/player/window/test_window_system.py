"""The window and the system: sizes, displays, closing, and what can be refused."""

import os
import re
import shutil
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gclip import Clip
from player.cli import main
from player.errors import PlayerError
from player.view.camera import Camera
from player.view.playback import Timeline
from player.view.state import Scene
from player.view.style import Style
from player.window import launch
from player.window.glfw_window import WindowSize
from player.window.launch import show
from player.window.viewports import TIMELINE_HEIGHT, TITLE_HEIGHT, home_camera, with_fitted_cameras
from tests.player.shown import DENSE, SIZE, TIMES, Shown, small_clip


def test_a_new_size_brings_a_new_home(shown: Shown) -> None:
    before = shown.states[-1]
    window = shown.xdotool("getwindowfocus")
    shown.xdotool("windowsize", window, 400, 700)
    after = shown.until(lambda state: state["home"] != before["home"])
    assert after["at_home"]
    shown.click(*shown.on_line(2.0))
    shown.until(lambda state: state["day"] == 2.0)
    shown.xdotool("windowsize", window, *SIZE)
    shown.until(lambda state: state["home"] == before["home"])


def test_full_screen_and_back(shown: Shown) -> None:
    before = shown.states[-1]["home"]
    shown.key("F11")
    shown.until(lambda state: state["fullscreen"] and state["home"] != before)
    assert "1280x960" in shown.xdotool("getwindowfocus", "getwindowgeometry")
    shown.key("Escape")
    shown.until(lambda state: not state["fullscreen"] and state["home"] == before)


def test_q_quits(shown: Shown) -> None:
    shown.key("q")
    assert shown.process.wait(timeout=120) == 0
    assert shown.process.stderr is not None
    assert shown.process.stderr.read() == ""


def test_a_dense_display_gets_more_pixels_and_the_mouse_stays_right(
    display: dict[str, str], clip_file: Path
) -> None:
    dense = Shown(display, clip_file, SIZE, before=DENSE)
    try:
        x, y = dense.on_line(2.0)
        dense.point(2 * x, 2 * y)
        assert "1280x960" in dense.xdotool("getwindowfocus", "getwindowgeometry")
        dense.key("space")
        dense.xdotool("click", 1)
        dense.until(lambda state: state["day"] == 2.0)
    finally:
        dense.end()


def test_an_old_opengl_is_refused_in_one_sentence(display: dict[str, str], clip_file: Path) -> None:
    code = (
        f"import gclip; from player.window.launch import show; show(gclip.open({str(clip_file)!r}))"
    )
    old = {**os.environ, **display, "MESA_GL_VERSION_OVERRIDE": "3.0"}
    done = subprocess.run([sys.executable, "-c", code], env=old, capture_output=True, text=True)
    assert "PlayerError: this display offers no OpenGL 3.3" in done.stderr
    assert "--export" in done.stderr


def test_the_time_of_each_pass_is_told_at_the_end(
    display: dict[str, str], clip_file: Path, tmp_path: Path
) -> None:
    environment = {**os.environ, **display, "XDG_CONFIG_HOME": str(tmp_path)}
    clip = shutil.copy(clip_file, tmp_path / "timed.gclip")
    command = [sys.executable, "-m", "player", clip, "--profile", "--size", "320x240"]
    played = subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True)
    search = ["xdotool", "search", "--sync", "--onlyvisible", "--name", "timed"]
    subprocess.run([*search, "sleep", "2"], env=environment, check=True, timeout=120)
    ends = time.monotonic() + 120.0
    while played.poll() is None and time.monotonic() < ends:
        quits = ["xdotool", "mousemove", "160", "100", "sleep", "2", "key", "q"]
        subprocess.run(quits, env=environment, check=True, timeout=120)
    played.kill()
    _, told = played.communicate()
    assert played.returncode == 0
    assert "picture" in told
    assert re.search(r"all of a frame \(\d+ timed\) +[\d.]+ ms", told)


def test_day_is_where_playback_starts(
    clip_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown = []

    def keep(clips: object, style: Style, **settings: Any) -> None:
        shown.append(settings["changes"]["timeline"])
        raise PlayerError("closed")

    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setattr(launch, "show", keep)
    assert main([str(clip_file), "--day", "2020-03-10"]) == 2
    assert shown == [replace(Timeline.of(TIMES).at(2.0), playing=True)]


def test_no_display_is_refused_in_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    if not sys.platform.startswith("linux"):
        pytest.skip("only X11 and Wayland can be without a display")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(PlayerError, match=r"no display .* --export"):
        show(small_clip())


def test_measures_of_a_dense_display() -> None:
    windows = WindowSize((1600, 900), (1600, 900), 2.0)  # cursor in pixels
    assert windows.units == (800.0, 450.0)
    assert windows.to_units(1600.0, 450.0) == (800.0, 225.0)
    mac = WindowSize((800, 450), (1600, 900), 2.0)  # cursor in units
    assert mac.units == (800.0, 450.0)
    assert mac.to_units(400.0, 450.0) == (400.0, 450.0)


def test_a_minimised_window_is_not_visible() -> None:
    assert not WindowSize((0, 0), (0, 0), 1.0).visible
    assert WindowSize((10, 10), (20, 20), 2.0).visible


def test_side_by_side_and_back_keeps_what_is_seen_of_the_plant() -> None:
    clip = small_clip()
    camera = home_camera(clip, (1000.0, 700.0))
    first = Scene(
        Timeline.of(clip.times), camera.zoom(1.5).orbit(0.3, 0.0), camera, Style(), (clip,)
    )
    beside = with_fitted_cameras(first, (150.0, 700.0))
    assert beside.camera.distance / beside.home.distance == pytest.approx(1 / 1.5)
    assert beside.camera.distance > first.camera.distance, "farther, to be seen whole"
    assert beside.camera.yaw == pytest.approx(first.camera.yaw)
    back = with_fitted_cameras(beside, (1000.0, 700.0))
    assert back.camera.distance == pytest.approx(first.camera.distance)


@pytest.mark.parametrize("turn", [0.0, 0.3], ids=["home", "turned"])
def test_a_plot_over_the_timeline_hides_nothing_of_the_plant(turn: float) -> None:
    clip, size, plot = small_clip(), (1000.0, 700.0), 96.0
    home = home_camera(clip, size)
    first = Scene(Timeline.of(clip.times), home.orbit(turn, 0.0), home, Style(), (clip,))
    raised = with_fitted_cameras(first, size, plot)
    lower, higher = (_lowest(clip, scene.camera, size) for scene in (first, raised))
    assert higher - lower == pytest.approx(plot, abs=15.0)
    back = with_fitted_cameras(raised, size)
    assert back.camera.distance == pytest.approx(first.camera.distance)
    assert back.camera.target == pytest.approx(first.camera.target)


def _lowest(clip: Clip, camera: Camera, size: tuple[float, float]) -> float:
    """Height of the lowest point in a window, in units from its lower edge."""
    matrix = camera.projection(size[0] / size[1]) @ camera.view()
    corners = np.c_[clip.at(clip.times[-1]).local, np.ones(200)] @ matrix.T
    return float(((1 + corners[:, 1] / corners[:, 3]) / 2 * size[1]).min())


@pytest.mark.parametrize("size", [(320, 240), (480, 360), (1280, 720), (500, 1400)])
def test_home_shows_the_plant_between_titles_and_timeline(size: tuple[int, int]) -> None:
    clip, (width, height) = small_clip(), size
    camera = home_camera(clip, size)
    matrix = camera.projection(width / height) @ camera.view()
    for day in np.linspace(TIMES[0], TIMES[-1], 7):
        corners = np.c_[clip.at(day).local, np.ones(200)] @ matrix.T
        x, y = (corners[:, :2] / corners[:, 3:]).T
        assert np.abs(x).max() <= 1.0
        assert ((1 - y) / 2 * height).min() >= min(TITLE_HEIGHT, 0.3 * height) - 0.01 * height
        assert ((1 + y) / 2 * height).min() >= min(TIMELINE_HEIGHT, 0.38 * height) - 0.01 * height
