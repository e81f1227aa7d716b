"""The one table of keys and mouse actions: it drives the handling, the help overlay and `--help`.

A key is named as GLFW does, in lower case ("space", "page_up", "f11"), or by the character typed
("?", "+"), which is right on every keyboard layout; "shift+left" asks for the modifier.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from player.scene import Scene

NUDGE = 0.01  # share of the series that an arrow key goes on
POINTS = "smaller, larger points"
POINT_STEP, SMALLEST, LARGEST = 1.15, 0.05, 20.0  # the command line allows the same
ZOOM_STEP = 1.12  # factor of one wheel notch
TURN = math.radians(180.0)  # orbit of a drag over the window's height

_SHOWN = {
    "space": "Space",
    "left": "←",
    "right": "→",
    "up": "↑",
    "down": "↓",
    "page_up": "PgUp",
    "page_down": "PgDn",
    "escape": "Esc",
    "home": "Home",
    "end": "End",
    "-": "−",
}


@dataclass(frozen=True)
class Action:
    """Something that keys, and perhaps a button on the screen, do to the scene.

    keys:    any of them does it.
    help:    what it does, in a few words.
    row:     the line of help that it shares with its neighbours, if it has no line of its own.
    repeats: goes on while the key is held.
    """

    name: str
    section: str
    keys: tuple[str, ...]
    help: str
    do: Callable[[Scene], Scene]
    row: str = ""
    repeats: bool = False

    @property
    def labels(self) -> tuple[str, ...]:
        """The keys as people read them: "Space", "Shift ←", "G"."""
        return tuple(label(key) for key in self.keys)


@dataclass(frozen=True)
class Drag:
    """A mouse button held and moved over the plant.

    do: from the scene and the way moved, (right, down) in window heights, to the next scene.
    """

    name: str
    button: str
    shift: bool
    label: str
    help: str
    do: Callable[[Scene, float, float], Scene]


def label(key: str) -> str:
    """A key's name as people read it."""
    *modifiers, last = key.split("+") if len(key) > 1 else [key]
    return " ".join([m.capitalize() for m in modifiers] + [_SHOWN.get(last, last.upper())])


def _recolored(scene: Scene) -> Scene:
    if not scene.has_colors:
        return scene.styled("This clip has no scan colours; organs are coloured by track.")
    chosen = "scan" if scene.color_by == "track" else "track"
    return scene.styled(f"Coloured by {chosen}", color_by=chosen)


def _resized(factor: float) -> Callable[[Scene], Scene]:
    def resize(scene: Scene) -> Scene:
        size = min(max(scene.style.point_size * factor, SMALLEST), LARGEST)
        size = 1.0 if abs(size - 1.0) < 0.01 else size
        return scene.styled(f"Point size {size:.0%}", point_size=size)

    return resize


def _looped(scene: Scene) -> Scene:
    scene = scene.clock(lambda t: t.with_next_end())
    return replace(scene, notice=f"At the end: {scene.timeline.at_end.value}")


def _grounded(scene: Scene) -> Scene:
    return scene.styled(ground="dark" if scene.style.ground == "light" else "light")


def _left(scene: Scene) -> Scene:
    """Esc leaves the help first, then the full screen, then the window."""
    if scene.help:
        return replace(scene, help=False)
    if scene.fullscreen:
        return replace(scene, fullscreen=False)
    return replace(scene, closed=True)


ACTIONS: tuple[Action, ...] = (
    Action("play", "Time", ("space",), "play, pause", lambda s: s.clock(lambda t: t.toggled())),
    Action(
        "back", "Time", ("left",), "back a little",
        lambda s: s.clock(lambda t: t.nudged(-NUDGE)), "back, on a little", repeats=True,
    ),
    Action(
        "on", "Time", ("right",), "on a little",
        lambda s: s.clock(lambda t: t.nudged(NUDGE)), "back, on a little", repeats=True,
    ),
    Action(
        "previous", "Time", ("page_up", "shift+left"), "previous scan",
        lambda s: s.clock(lambda t: t.stepped(-1)), "previous, next scan", repeats=True,
    ),
    Action(
        "next", "Time", ("page_down", "shift+right"), "next scan",
        lambda s: s.clock(lambda t: t.stepped(1)), "previous, next scan", repeats=True,
    ),
    Action(
        "first", "Time", ("home",), "first scan",
        lambda s: s.clock(lambda t: t.at(t.first)), "first, last scan",
    ),
    Action(
        "last", "Time", ("end",), "last scan",
        lambda s: s.clock(lambda t: t.at(t.last)), "first, last scan",
    ),
    Action(
        "slower", "Time", ("[", "down"), "slower",
        lambda s: s.clock(lambda t: t.slower()), "slower, faster",
    ),
    Action(
        "faster", "Time", ("]", "up"), "faster",
        lambda s: s.clock(lambda t: t.faster()), "slower, faster",
    ),
    Action("at end", "Time", ("l",), "loop, back and forth, or stop", _looped),
    Action(
        "fit", "View", ("f",), "whole plant",
        lambda s: replace(s, camera=s.home, turning=False),
    ),
    Action(
        "turn", "View", ("t",), "go round the plant",
        lambda s: replace(s, turning=not s.turning),
    ),
    Action(
        "fullscreen", "View", ("f11",), "full screen",
        lambda s: replace(s, fullscreen=not s.fullscreen),
    ),
    Action("color", "Look", ("c",), "colour by scan or by track", _recolored),
    Action("smaller", "Look", ("-",), "smaller points", _resized(1 / POINT_STEP), POINTS, True),
    Action("larger", "Look", ("+", "="), "larger points", _resized(POINT_STEP), POINTS, True),
    Action("ground", "Look", ("g",), "light or dark ground", _grounded),
    Action(
        "depth", "Look", ("d",), "depth cue on or off",
        lambda s: s.styled(depth_cue=not s.style.depth_cue),
    ),
    Action(
        "picture", "Window", ("s",), "save a screenshot",
        lambda s: replace(s, wants_picture=True),
    ),
    Action(
        "help", "Window", ("h", "?", "f1"), "show this help",
        lambda s: replace(s, help=not s.help),
    ),
    Action("leave", "Window", ("escape",), "leave full screen, or quit", _left),
    Action("quit", "Window", ("q",), "quit", lambda s: replace(s, closed=True)),
)  # fmt: skip


def _orbited(scene: Scene, right: float, down: float) -> Scene:
    return scene.seen(lambda c: c.orbit(-TURN * right, TURN * down))


def _panned(scene: Scene, right: float, down: float) -> Scene:
    return scene.seen(lambda c: c.pan(right, -down))


DRAGS: tuple[Drag, ...] = (
    Drag("orbit", "left", False, "Drag", "turn the plant", _orbited),
    Drag("pan", "left", True, "Shift drag", "shift the plant", _panned),
    Drag("pan", "right", False, "Right drag", "shift the plant", _panned),
    Drag("pan", "middle", False, "Middle drag", "shift the plant", _panned),
)


def wheeled(scene: Scene, notches: float) -> Scene:
    """The wheel over the window: nearer for a turn away from the user."""
    return scene.seen(lambda c: c.zoom(ZOOM_STEP**notches))


def scrubbed(scene: Scene, day: float) -> Scene:
    """A click or drag on the timeline."""
    return scene.clock(lambda t: t.at(day))


def action(name: str) -> Action:
    return next(action for action in ACTIONS if action.name == name)


def action_for(key: str) -> Action | None:
    """What a key does, None where it does nothing."""
    return next((action for action in ACTIONS if key in action.keys), None)


def drag_for(button: str, shift: bool) -> Drag | None:
    """What a mouse button does; shift counts only where the table gives it a meaning of its own."""
    fitting = [drag for drag in DRAGS if drag.button == button and drag.shift in (shift, False)]
    return max(fitting, key=lambda drag: drag.shift, default=None)


def sections() -> dict[str, list[tuple[tuple[str, ...], str]]]:
    """What to show as help: for each section its rows (key labels, what they do)."""
    table: dict[str, dict[str, list[str]]] = {}
    for entry in ACTIONS:
        rows = table.setdefault(entry.section, {})
        if entry.section == "View" and not rows:
            rows.update(_mouse_rows())
        rows.setdefault(entry.row or entry.help, []).extend(entry.labels)
        if entry.name == "play":
            rows["go to a day"] = ["Drag timeline"]
    return {
        section: [(tuple(labels), text) for text, labels in rows.items()]
        for section, rows in table.items()
    }


def _mouse_rows() -> dict[str, list[str]]:
    rows: dict[str, list[str]] = {}
    for drag in DRAGS:
        rows.setdefault(drag.help, []).append(drag.label)
    return {**rows, "nearer, farther": ["Wheel"]}


def help_text() -> str:
    """The table as plain text, for `play --help`."""
    table = sections()
    width = max(len(", ".join(labels)) for rows in table.values() for labels, _ in rows)
    lines = ["Keys and mouse in the window"]
    for section, rows in table.items():
        lines += ["", section]
        lines += [f"  {', '.join(labels):<{width}}  {text}" for labels, text in rows]
    return "\n".join(lines)
