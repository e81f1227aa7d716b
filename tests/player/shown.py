"""A window in a process of its own, worked with real keys and a real mouse (xdotool)."""

import json
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from baker.interpolation.packing import Movers, pack_interval
from gclip import Clip, Motion, ScanMark, Track
from player.ui.timeline import Line

SIZE = (640, 480)
TIMES = (0.0, 2.0, 3.0)
DATES = ("2020-03-08", "2020-03-10", "2020-03-11")

# Shows clips and tells after each picture what is seen, and where the controls are.
SHOW = """
import json, sys, time
from pathlib import Path
import pytest
from player.window.launch import show
from player.window.opened_clip import OpenClip
from tests.player.desk import Places

places = Places(pytest.MonkeyPatch()).found

def tell(scene):
    t, c, s = scene.timeline, scene.camera, scene.style
    print(json.dumps({
        "day": t.day, "playing": t.playing, "speed": t.speed, "at_end": t.at_end.value,
        "times": t.times,
        "yaw": c.yaw, "pitch": c.pitch, "distance": c.distance, "target": c.target,
        "flat": c.orthographic, "at_home": c == scene.home, "home": scene.home.distance,
        "ground": s.ground, "point_size": s.point_size, "color_by": scene.color_mode,
        "picked": s.picked, "second": s.second,
        "hidden": sorted(s.hidden), "alone": s.isolated,
        "floor": s.floor, "compare": scene.compare.value, "wipe": scene.wipe,
        "keys": len(scene.path.keys), "following": scene.following, "turning": scene.turning,
        "panel": scene.panel, "help": scene.help, "notice": scene.notice,
        "fullscreen": scene.fullscreen, "output": scene.output.example,
        "places": places, "clock": time.monotonic(),
    }), flush=True)
    places.clear()

if __name__ == "__main__":
    width, height = map(int, sys.argv[1:3])
    changes, files = json.loads(sys.argv[3]), sys.argv[4:]
    clips = [OpenClip.from_file(Path(file)) for file in files]
    show(clips, size=(width, height), watch=tell, changes=changes)
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
        self,
        display: dict[str, str],
        clips: Path | list[Path],
        size: tuple[int, int],
        before: str = "",
        **changes: object,
    ) -> None:
        """changes: of the first scene. before: code that runs before all else."""
        files = clips if isinstance(clips, list) else [clips]
        root = str(Path(__file__).parents[2])
        paths = [root, os.environ.get("PYTHONPATH", "")]
        self.environment = {**os.environ, **display, "PYTHONPATH": os.pathsep.join(paths)}
        self.states: list[State] = []
        self.process = subprocess.Popen(
            [sys.executable, "-c", before + SHOW, *map(str, size), json.dumps(changes),
             *map(str, files)],
            env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            cwd=files[0].parent,
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

    def until(self, met: Callable[[State], bool], seconds: float = 120.0) -> State:
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

    def settled(self, quiet: float = 0.3, seconds: float = 120.0) -> State:
        """The state once no picture has come for so long."""
        deadline, seen = time.monotonic() + seconds, -1
        while seen != len(self.states):
            if time.monotonic() > deadline:
                raise AssertionError(f"pictures still come after {seconds} s: {self.states[-1:]}")
            seen = len(self.states)
            time.sleep(quiet)
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

    def middle(self, name: str) -> tuple[float, float]:
        """Of a control, by its action."""
        left, top, right, bottom = self.states[-1]["places"][name]
        return (left + right) / 2, (top + bottom) / 2

    def on_line(self, day: float) -> tuple[float, float]:
        """Where a day stands on the timeline."""
        left, top, right, bottom = self.states[-1]["places"]["timeline"]
        half, times = (bottom - top) / 4, self.states[-1]["times"]
        line = Line(left + half, right - half, (top + bottom) / 2, tuple(times))
        return line.x_of(day), line.height

    def click(self, x: float, y: float) -> None:
        """Without waiting: what a click means must not depend on when pictures come."""
        self.xdotool("mousemove", round(x), round(y), "click", 1)

    def end(self) -> None:
        self.process.kill()
        self.process.wait()


def small_clip(
    dates: Sequence[str] = DATES, times: Sequence[float] = TIMES, leaf: str = "leaf"
) -> Clip:
    """As many scans as dates, of a stem and a leaf.

    leaf: the leaf's name.
    """
    rng = np.random.default_rng(5)
    scans = [rng.random((200, 3)) * [1, 1, 3] for _ in dates]
    colors = rng.integers(0, 256, (200, 4), np.uint8)
    tracks = np.repeat([0, 1], 100)
    return Clip(
        scans=tuple(ScanMark(date, t, date, 200) for date, t in zip(dates, times, strict=False)),
        intervals=tuple(
            pack_interval(*days, [Movers(Motion.MOVE, ends, tracks, colors, colors)], spacing=0.1)
            for days, ends in zip(pairwise(times), pairwise(scans), strict=False)
        ),
        track_table=(Track(0, "stem", (90, 160, 60)), Track(1, leaf, (60, 90, 200), parent=0)),
        spacing=0.1,
    )
