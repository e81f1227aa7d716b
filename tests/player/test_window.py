"""The real window, with real keys and a real mouse, on a display of its own (Xvfb, xdotool)."""

import json
import os
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gclip import Clip, Motion, ScanMark, Track
from gclip.pack import Movers, pack_interval
from player.errors import PlayerError
from player.layout import Layout, arrange
from player.window import Measures, home_camera, show

SIZE = (640, 480)
TIMES = (0.0, 2.0, 3.0)
DATES = ("2020-03-08", "2020-03-10", "2020-03-11")

# Shows a clip and tells after each picture what is seen.
SHOW = """
import json, sys
import gclip
from player.window import show

def tell(scene):
    t, c, s = scene.timeline, scene.camera, scene.style
    print(json.dumps({
        "day": t.day, "playing": t.playing, "speed": t.speed, "at_end": t.at_end.value,
        "yaw": c.yaw, "pitch": c.pitch, "distance": c.distance, "target": c.target,
        "at_home": c == scene.home, "home": scene.home.distance,
        "ground": s.ground, "point_size": s.point_size, "color_by": scene.color_by,
        "help": scene.help, "notice": scene.notice, "fullscreen": scene.fullscreen,
    }), flush=True)

width, height = map(int, sys.argv[2:4])
show(gclip.open(sys.argv[1]), name="plant.gclip", size=(width, height), watch=tell)
"""

# Tells every program on the display that it is twice as dense, while a client keeps it alive.
DENSE = """
import ctypes
x11 = ctypes.CDLL("libX11.so.6")
x11.XOpenDisplay.restype = ctypes.c_void_p
x11.XDefaultRootWindow.restype = x11.XInternAtom.restype = ctypes.c_ulong
display = ctypes.c_void_p(x11.XOpenDisplay(None))
root = ctypes.c_ulong(x11.XDefaultRootWindow(display))
resources = ctypes.c_ulong(x11.XInternAtom(display, b"RESOURCE_MANAGER", 0))
text = b"Xft.dpi:\\t192\\n"
x11.XChangeProperty(display, root, resources, ctypes.c_ulong(31), 8, 0, text, len(text))
x11.XSync(display, 0)
"""

State = dict[str, Any]


class Shown:
    """A window that plays a clip in a process of its own."""

    def __init__(
        self, display: dict[str, str], clip: Path, size: tuple[int, int], before: str = ""
    ) -> None:
        self.environment = {**os.environ, **display}
        self.states: list[State] = []
        self.process = subprocess.Popen(
            [sys.executable, "-c", before + SHOW, str(clip), *map(str, size)],
            env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            cwd=clip.parent,
        )  # fmt: skip
        threading.Thread(target=self._listen, daemon=True).start()
        self.until(lambda state: True)

    def _listen(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.states.append(json.loads(line))

    def xdotool(self, *words: object) -> str:
        done = subprocess.run(
            ["xdotool", *map(str, words)],
            env=self.environment, check=True, capture_output=True, text=True,
        )  # fmt: skip
        return done.stdout.strip()

    def until(self, met: Callable[[State], bool], seconds: float = 20.0) -> State:
        """The newest state, as soon as it is as wished."""
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            if self.states and met(self.states[-1]):
                return self.states[-1]
            if self.process.poll() is not None:
                break
            time.sleep(0.01)
        errors = self.process.stderr.read() if self.process.poll() is not None else ""  # type: ignore[union-attr]
        raise AssertionError(f"not so within {seconds} s: {self.states[-1:]} {errors}")

    def settled(self) -> State:
        """The state once no more pictures come."""
        seen = -1
        while seen != len(self.states):
            seen = len(self.states)
            time.sleep(0.3)
        return self.states[-1]

    def key(self, *keys: str) -> None:
        self.xdotool("key", "--delay", 30, *keys)

    def drag(self, button: int, start: tuple[float, float], end: tuple[float, float]) -> None:
        self.point(*start)
        self.xdotool("mousedown", button)
        self.point((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
        self.point(*end)
        self.xdotool("mouseup", button)

    def point(self, x: float, y: float) -> None:
        self.xdotool("mousemove", round(x), round(y))

    def end(self) -> None:
        self.process.kill()
        self.process.wait()


@pytest.fixture(scope="module")
def display() -> Iterator[dict[str, str]]:
    for program in ("Xvfb", "xdotool"):
        if shutil.which(program) is None:
            pytest.skip(f"{program} is not installed (apt-get install xvfb xdotool)")
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", "1", "-screen", "0", "1280x960x24", "-noreset"],
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
    )  # fmt: skip
    assert server.stdout is not None
    number = server.stdout.readline().strip()
    yield {"DISPLAY": f":{number}", "WAYLAND_DISPLAY": "", "XDG_SESSION_TYPE": "x11"}
    server.terminate()
    server.wait(timeout=20)


@pytest.fixture(scope="module")
def clip_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("clip") / "plant.gclip"
    small_clip().save(path)
    return path


def small_clip() -> Clip:
    rng = np.random.default_rng(5)
    scans = [rng.random((200, 3)) * [1, 1, 3] for _ in TIMES]
    colors = rng.integers(0, 256, (200, 4), np.uint8)
    tracks = np.repeat([0, 1], 100)
    return Clip(
        tuple(ScanMark(date, t, date, 200) for t, date in zip(TIMES, DATES, strict=True)),
        tuple(
            pack_interval(
                TIMES[k], TIMES[k + 1],
                [Movers(Motion.MOVE, (scans[k], scans[k + 1]), tracks, colors, colors)],
                spacing=0.1,
            )
            for k in range(2)
        ),
        (Track(0, "stem", (90, 160, 60)), Track(1, "leaf", (60, 90, 200), parent=0)),
        spacing=0.1,
    )  # fmt: skip


@pytest.fixture(scope="module")
def opened(display: dict[str, str], clip_file: Path) -> Iterator[Shown]:
    shown = Shown(display, clip_file, SIZE)
    yield shown
    shown.end()


@pytest.fixture
def shown(opened: Shown) -> Shown:
    """The open window, paused at the first scan, seen from home, the mouse on the plant."""
    opened.point(320, 200)
    if opened.states[-1]["help"]:
        opened.key("h")
    if opened.states[-1]["playing"]:
        opened.key("space")
        opened.until(lambda state: not state["playing"])
    opened.key("Home", "f")
    opened.until(lambda state: state["day"] == 0.0 and state["at_home"] and not state["notice"])
    return opened


def layout(size: tuple[float, float] = SIZE) -> Layout:
    return arrange(size, TIMES, DATES, DATES, lambda text, height: 1.0)


def test_it_plays_by_itself_and_space_pauses(opened: Shown) -> None:
    first = opened.until(lambda state: state["playing"])
    opened.until(lambda state: state["day"] > first["day"] + 0.05)
    opened.point(320, 200)
    opened.key("space")
    assert not opened.until(lambda state: not state["playing"])["playing"]


def test_nothing_is_drawn_while_nothing_changes(shown: Shown) -> None:
    shown.settled()
    pictures = len(shown.states)
    time.sleep(1.0)
    assert len(shown.states) == pictures
    shown.key("g")
    shown.until(lambda state: len(shown.states) > pictures)
    shown.key("g")


def test_time_passes_at_the_clock_s_pace_not_the_frames_(shown: Shown) -> None:
    began = time.monotonic()
    shown.key("space")
    state = shown.until(lambda state: state["day"] > 0.9)
    took = time.monotonic() - began
    assert state["day"] == pytest.approx(0.75 * took, abs=0.5)  # three days in four seconds


def test_a_click_on_a_scan_s_mark_goes_to_that_scan(shown: Shown) -> None:
    shown.point(layout().x_of(2.0), layout().line)
    shown.xdotool("click", 1)
    shown.until(lambda state: state["day"] == 2.0)
    shown.until(lambda state: "2020-03-10" in shown.xdotool("getwindowfocus", "getwindowname"))


def test_dragging_the_timeline_scrubs_there_and_back(shown: Shown) -> None:
    place = layout()
    shown.drag(1, (place.x_of(0.0), place.line), (place.x_of(1.3), place.line - 60))
    state = shown.until(lambda state: state["day"] > 1.0)
    assert shown.settled()["day"] == pytest.approx(1.3, abs=0.02)
    assert state["at_home"]
    shown.drag(1, (place.x_of(1.3), place.line), (5, place.line))
    shown.until(lambda state: state["day"] == 0.0)


def test_keys_step_through_the_scans(shown: Shown) -> None:
    shown.key("Next")
    shown.until(lambda state: state["day"] == 2.0)
    shown.key("shift+Right")
    shown.until(lambda state: state["day"] == 3.0)
    shown.key("Prior", "Left")
    shown.until(lambda state: state["day"] == pytest.approx(1.97))
    shown.key("End")
    shown.until(lambda state: state["day"] == 3.0)


def test_left_drag_orbits(shown: Shown) -> None:
    before = shown.settled()
    shown.drag(1, (320, 200), (400, 240))
    after = shown.until(lambda state: state["pitch"] > before["pitch"] + 0.1)
    assert shown.settled()["yaw"] != before["yaw"]
    assert after["target"] == before["target"]
    shown.key("f")
    assert shown.until(lambda state: state["at_home"])["yaw"] == pytest.approx(before["yaw"])


@pytest.mark.parametrize("button", [2, 3, "shift"])
def test_right_middle_and_shift_drag_pan(shown: Shown, button: int | str) -> None:
    before = shown.settled()
    if button == "shift":
        shown.xdotool("keydown", "shift")
    shown.drag(1 if button == "shift" else int(button), (320, 200), (360, 160))
    if button == "shift":
        shown.xdotool("keyup", "shift")
    shown.until(lambda state: state["target"] != before["target"])
    after = shown.settled()
    assert (after["yaw"], after["pitch"]) == (before["yaw"], before["pitch"])


def test_the_wheel_zooms(shown: Shown) -> None:
    before = shown.settled()["distance"]
    shown.xdotool("click", "--repeat", 3, 4)
    shown.until(lambda state: state["distance"] < 0.8 * before)
    shown.xdotool("click", "--repeat", 3, 5)
    shown.until(lambda state: state["distance"] == pytest.approx(before))


def test_keys_change_the_look_the_speed_and_the_end(shown: Shown) -> None:
    was = shown.settled()
    shown.key("g", "c", "plus", "bracketright", "l")
    now = shown.until(lambda state: state["at_end"] != was["at_end"])
    assert (was["ground"], now["ground"]) == ("dark", "light")
    assert (was["color_by"], now["color_by"]) == ("scan", "track")
    assert now["point_size"] > was["point_size"]
    assert now["speed"] == 2 * was["speed"]
    shown.key("g", "c", "minus", "bracketleft", "l", "l")
    now = shown.until(lambda state: state["at_end"] == was["at_end"])
    same = ("ground", "color_by", "point_size", "speed")
    assert [now[name] for name in same] == [was[name] for name in same]


def test_the_play_button_plays(shown: Shown) -> None:
    shown.point(*layout().buttons["play"].middle)
    shown.xdotool("click", 1)
    shown.until(lambda state: state["playing"] and state["day"] > 0.0)


def test_the_help_opens_and_escape_only_closes_it(shown: Shown) -> None:
    shown.key("question")
    shown.until(lambda state: state["help"])
    shown.key("Escape")
    shown.until(lambda state: not state["help"])
    assert shown.process.poll() is None


def test_a_screenshot_is_saved_where_the_user_stands(shown: Shown, clip_file: Path) -> None:
    from PIL import Image

    shown.key("s")
    notice = shown.until(lambda state: state["notice"].startswith("Saved"))["notice"]
    with Image.open(clip_file.parent / notice.removeprefix("Saved ")) as picture:
        assert picture.size == SIZE
        assert len(np.unique(np.asarray(picture).reshape(-1, 3), axis=0)) > 20


def test_a_new_size_brings_a_new_home(shown: Shown) -> None:
    before = shown.settled()
    window = shown.xdotool("getwindowfocus")
    shown.xdotool("windowsize", window, 400, 700)
    after = shown.until(lambda state: state["home"] != before["home"])
    assert after["at_home"]
    wide = layout((400.0, 700.0))
    shown.point(wide.x_of(2.0), wide.line)
    shown.xdotool("click", 1)
    shown.until(lambda state: state["day"] == 2.0)
    shown.xdotool("windowsize", window, *SIZE)
    shown.until(lambda state: state["home"] == before["home"])


def test_full_screen_and_back(shown: Shown) -> None:
    before = shown.settled()["home"]
    shown.key("F11")
    shown.until(lambda state: state["fullscreen"] and state["home"] != before)
    assert "1280x960" in shown.xdotool("getwindowfocus", "getwindowgeometry")
    shown.key("Escape")
    shown.until(lambda state: not state["fullscreen"] and state["home"] == before)


def test_q_quits(shown: Shown) -> None:
    shown.key("q")
    assert shown.process.wait(timeout=20) == 0
    assert shown.process.stderr is not None
    assert shown.process.stderr.read() == ""


def test_a_dense_display_gets_more_pixels_and_the_mouse_stays_right(
    display: dict[str, str], clip_file: Path
) -> None:
    dense = Shown(display, clip_file, SIZE, before=DENSE)
    try:
        place = layout()
        dense.point(2 * place.x_of(2.0), 2 * place.line)
        assert "1280x960" in dense.xdotool("getwindowfocus", "getwindowgeometry")
        dense.key("space")
        dense.xdotool("click", 1)
        dense.until(lambda state: state["day"] == 2.0)
    finally:
        dense.end()


def test_an_old_opengl_is_refused_in_one_sentence(display: dict[str, str], clip_file: Path) -> None:
    code = f"import gclip; from player.window import show; show(gclip.open({str(clip_file)!r}))"
    old = {**os.environ, **display, "MESA_GL_VERSION_OVERRIDE": "3.0"}
    done = subprocess.run([sys.executable, "-c", code], env=old, capture_output=True, text=True)
    assert "PlayerError: this display offers no OpenGL 3.3" in done.stderr
    assert "--export" in done.stderr


def test_no_display_is_refused_in_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    if not sys.platform.startswith("linux"):
        pytest.skip("only X11 and Wayland can be without a display")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(PlayerError, match=r"no display .* --export"):
        show(small_clip())


def test_measures_of_a_dense_display() -> None:
    windows = Measures((1600, 900), (1600, 900), 2.0)  # cursor in pixels
    assert windows.units == (800.0, 450.0)
    assert windows.to_units(1600.0, 450.0) == (800.0, 225.0)
    mac = Measures((800, 450), (1600, 900), 2.0)  # cursor in units
    assert mac.units == (800.0, 450.0)
    assert mac.to_units(400.0, 450.0) == (400.0, 450.0)


def test_a_minimised_window_is_not_visible() -> None:
    assert not Measures((0, 0), (0, 0), 1.0).visible
    assert Measures((10, 10), (20, 20), 2.0).visible


@pytest.mark.parametrize("size", [(320, 240), (480, 360), (1280, 720), (500, 1400)])
def test_home_shows_the_plant_between_titles_and_timeline(size: tuple[int, int]) -> None:
    from player.layout import ABOVE_PLANT, BELOW_PLANT

    clip, (width, height) = small_clip(), size
    camera = home_camera(clip, size)
    matrix = camera.projection(width / height) @ camera.view()
    for day in np.linspace(TIMES[0], TIMES[-1], 7):
        corners = np.c_[clip.at(day).local, np.ones(200)] @ matrix.T
        x, y = (corners[:, :2] / corners[:, 3:]).T
        assert np.abs(x).max() <= 1.0
        assert ((1 - y) / 2 * height).min() >= min(ABOVE_PLANT, 0.3 * height) - 0.01 * height
        assert ((1 + y) / 2 * height).min() >= min(BELOW_PLANT, 0.38 * height) - 0.01 * height
