"""The one table of keys and mouse actions: it drives the handling, the help overlay and `--help`.

A key is named as GLFW does, in lower case ("space", "page_up", "f11"), or by the character typed
("?", "+"), which is right on every keyboard layout; "shift+left" asks for the modifier.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import TYPE_CHECKING

from player.ui import actions
from player.view.choices import Wish

if TYPE_CHECKING:
    from player.view.state import Scene

NUDGE = 0.01  # share of the series that an arrow key goes on
STEP = 1.15  # factor of point sizes
WIPE_STEP = 0.05  # share of the width
# Lines of help that actions share.
NUDGED, FRAMED, STEPPED = "back, on a little", "one frame back, on", "previous, next scan"
RANGE, SIDES = "play from, up to here", "front, side, back, top"
KEYED, SIZED = "add, remove a camera key", "smaller, larger points"
ORGANS, UNDONE = "next, previous organ", "undo, redo a correction"
WIPED = "move the wipe"
# What the mouse does (mouse.py), as the help tells it beside the keys.
MOUSE = {
    "Time": {"go to a day": ["Drag timeline"]},
    "View": {
        "turn the plant": ["Drag"],
        "shift the plant": ["Shift drag", "Right drag", "Middle drag"],
        "nearer, farther": ["Wheel"],
    },
    "Organs": {"pick an organ": ["Click"], "choose a second one": ["Shift click"]},
    "Compare": {WIPED: ["Drag line"]},
}

_SHOWN = {
    "left": "←",
    "right": "→",
    "up": "↑",
    "down": "↓",
    "page_up": "PgUp",
    "page_down": "PgDn",
    "escape": "Esc",
    "-": "−",
}


@dataclass(frozen=True)
class Action:
    """Something that keys, and perhaps a button on the screen, do to the scene."""

    name: str
    keys: str  #: any of them does it, with spaces between them
    help: str  #: what it does, in a few words
    do: Callable[[Scene], Scene]
    #: the line of help that it shares with its neighbours, if it has no line of its own
    row: str = ""
    repeats: bool = False  #: goes on while the key is held
    on: Callable[[Scene], bool] | None = None  #: whether it is on, if it turns something on and off

    @property
    def labels(self) -> tuple[str, ...]:
        """The keys as people read them: "Space", "Shift ←", "G"."""
        return tuple(label(key) for key in self.keys.split())


def label(key: str) -> str:
    """A key's name as people read it."""
    *modifiers, last = key.split("+") if len(key) > 1 else [key]
    return " ".join([m.capitalize() for m in modifiers] + [_SHOWN.get(last, last.capitalize())])


def _time(move: str, *given: float, notice: str = "") -> Callable[[Scene], Scene]:
    """A move of the timeline, by its name."""

    def do(scene: Scene) -> Scene:
        scene = scene.with_timeline(lambda timeline: getattr(timeline, move)(*given))
        return scene.with_notice(notice) if notice else scene

    return do


def _switch(name: str, keys: str, help: str, field: str) -> Action:
    """What turns a field of the scene, or of a part of it, on and off."""
    value = attrgetter(field)
    return Action(name, keys, help, lambda scene: scene.changed(field, not value(scene)), on=value)


def _wish(name: str, key: str, help: str, wish: Wish) -> Action:
    """What the window does when it draws the next picture."""
    return Action(name, key, help, lambda scene: replace(scene, wish=wish))


TABLE: dict[str, tuple[Action, ...]] = {
    "Time": (
        Action("play", "space", "play, pause", _time("toggled")),
        Action("back", "left", "back a little", _time("nudged", -NUDGE), NUDGED, True),
        Action("on", "right", "on a little", _time("nudged", NUDGE), NUDGED, True),
        Action("frame back", ",", "one frame back", _time("framed", -1), FRAMED, True),
        Action("frame on", ".", "one frame on", _time("framed", 1), FRAMED, True),
        Action(
            "previous", "page_up shift+left", "previous scan",
            _time("stepped", -1), STEPPED, True,
        ),
        Action("next", "page_down shift+right", "next scan", _time("stepped", 1), STEPPED, True),
        Action("first", "home", "first scan", _time("at", -math.inf), "first, last scan"),
        Action("last", "end", "last scan", _time("at", math.inf), "first, last scan"),
        Action("slower", "[ down", "slower", _time("slower"), "slower, faster"),
        Action("faster", "] up", "faster", _time("faster"), "slower, faster"),
        Action("at end", "l", "loop, back and forth, or stop", actions.AT_END.next),
        Action(
            "begin", "i", "play from here",
            _time("begun_here", notice="Plays from here"), RANGE,
        ),
        Action(
            "end", "o", "play up to here",
            _time("ended_here", notice="Plays up to here"), RANGE,
        ),
        Action(
            "whole", "u", "play the whole series",
            _time("unbounded", notice="Plays the whole series"),
        ),
    ),
    "View": (
        Action("fit", "f", "whole plant", actions.go_home),
        Action("front", "1", "from the front", lambda s: actions.look_from(s, 0), SIDES),
        Action("side", "2", "from the side", lambda s: actions.look_from(s, 90), SIDES),
        Action("behind", "3", "from behind", lambda s: actions.look_from(s, 180), SIDES),
        Action("above", "4", "from above", lambda s: actions.look_from(s, 0, 90), SIDES),
        Action(
            "parallel", "5", "parallel projection", actions.switch_projection,
            on=lambda s: s.camera.orthographic,
        ),
        Action(
            "turn", "t", "go round the plant",
            lambda s: replace(s, turning=not s.turning, following=False), on=lambda s: s.turning,
        ),
        Action("add key", "k", "add a camera key", actions.add_key, KEYED),
        Action("drop key", "shift+k", "remove a camera key", actions.remove_key, KEYED),
        Action(
            "follow", "j", "follow the camera's path", actions.follow_path,
            on=lambda s: s.following,
        ),
        Action("save path", "shift+j", "save the camera's path", actions.save_path),
    ),
    "Look": (
        Action("color", "c", "colour by something else", actions.COLOR.next),
        Action("colormap", "shift+m", "other colours of values", actions.COLOR_MAP.next),
        Action(
            "smaller", "-", "smaller points",
            lambda s: actions.resize_points(s, 1 / STEP), SIZED, True,
        ),
        Action(
            "larger", "+ =", "larger points", lambda s: actions.resize_points(s, STEP), SIZED, True
        ),
        Action(
            "pixels", "p", "points sized in pixels", actions.switch_pixels,
            on=lambda s: s.style.pixels is not None,
        ),
        Action(
            "ground", "g", "light background",
            lambda s: s.with_style(ground="dark" if s.style.ground == "light" else "light"),
            on=lambda s: s.style.ground == "light",
        ),
        _switch("floor", "b", "floor and shadow", "style.show_ground"),
        _switch("depth", "d", "depth cue", "style.depth_cue"),
        Action("shading", "m", "shading: none, soft, strong", actions.next_shading),
        _switch("guides", "a", "scale bar and axes", "guides"),
        _switch("legend", "y", "legend", "legend"),
    ),
    "Organs": (
        Action("next organ", "n", "next organ", lambda s: actions.pick_next(s, 1), ORGANS),
        Action(
            "last organ", "shift+n", "previous organ",
            lambda s: actions.pick_next(s, -1), ORGANS,
        ),
        Action("hide", "x", "hide the organ", actions.hide_picked),
        Action("curve", "shift+l", "plot another trait", actions.CURVE.next),
        Action(
            "alone", "z", "show the organ alone", actions.isolate_picked,
            on=lambda s: s.style.alone is not None,
        ),
        Action(
            "show all", "shift+x", "show all organs",
            lambda s: s.with_style(hidden=frozenset(), alone=None),
        ),
        Action("same", "w", "two organs are the same", lambda s: actions.correct(s, "same")),
        Action(
            "different", "shift+w", "two organs are not the same",
            lambda s: actions.correct(s, "different"),
        ),
        Action("cut", "shift+c", "cut an organ where clicked", lambda s: actions.correct(s, "cut")),
        Action(
            "undo", "ctrl+z", "undo a correction",
            lambda s: replace(s, edits=s.edits and s.edits.undone()), UNDONE,
        ),
        Action(
            "redo", "shift+ctrl+z", "redo a correction",
            lambda s: replace(s, edits=s.edits and s.edits.redone()), UNDONE,
        ),
    ),
    "Compare": (
        Action("compare", "v", "with the nearest scan", actions.COMPARE.next),
        Action(
            "wipe left", "<", "wipe to the left",
            lambda s: actions.wipe_to(s, s.wipe - WIPE_STEP), WIPED, True,
        ),
        Action(
            "wipe right", ">", "wipe to the right",
            lambda s: actions.wipe_to(s, s.wipe + WIPE_STEP), WIPED, True,
        ),
    ),
    "Window": (
        _wish("picture", "s", "save a picture", Wish.PICTURE),
        _wish("export", "e", "export, or stop exporting", Wish.EXPORT),
        Action("format", "shift+e", "choose what to export", actions.FORMAT.next),
        Action("size", "r", "size of pictures", actions.SIZE.next),
        _switch("transparent", "shift+s", "pictures without background", "output.transparent"),
        _switch("panel", "tab", "panel", "panel"),
        _switch("fullscreen", "f11", "full screen", "fullscreen"),
        _switch("help", "h ? f1", "this help", "help"),
        Action("leave", "escape", "close, let go, or quit", actions.escape),
        Action("quit", "q", "quit", lambda s: replace(s, closed=True)),
    ),
}  # fmt: skip
ACTIONS = {action.name: action for section in TABLE.values() for action in section}
BY_KEY = {key: action for action in ACTIONS.values() for key in action.keys.split()}


def pressed(scene: Scene, key: str, shift: bool = False, repeated: bool = False) -> Scene:
    """A key, by its name or the character typed, went down, or repeats while it is held."""
    found = (BY_KEY.get(f"shift+{key}") if shift else None) or BY_KEY.get(key)
    return found.do(scene) if found and (found.repeats or not repeated) else scene


def sections() -> dict[str, dict[str, list[str]]]:
    """What to show as help: for each section its rows, what they do and the keys' labels."""
    table = {}
    for section, entries in TABLE.items():
        rows = {text: [*labels] for text, labels in MOUSE.get(section, {}).items()}
        for action in entries:
            rows.setdefault(action.row or action.help, []).extend(action.labels)
        table[section] = rows
    return table


def help_text() -> str:
    """The table as plain text, for `play --help`."""
    table = sections()
    width = max(len("  ".join(labels)) for rows in table.values() for labels in rows.values())
    lines = ["Keys and mouse in the window"]
    for section, rows in table.items():
        lines += ["", section]
        lines += [f"  {'  '.join(labels):<{width}}   {text}" for text, labels in rows.items()]
    return "\n".join(lines)
