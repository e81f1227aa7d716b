"""The one table of keys and mouse actions: it drives the handling, the help overlay and `--help`.

A key is named as GLFW does, in lower case ("space", "page_up", "f11"), or by the character typed
("?", "+"), which is right on every keyboard layout; "shift+left" asks for the modifier.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from player.ui import actions
from player.ui.actions import STEP
from player.view.choices import Wish

if TYPE_CHECKING:
    from player.view.state import Scene

NUDGE = 0.01  # share of the series that an arrow key goes on
NUDGED, FRAMED = "back, on a little", "one frame back, on"
BOUNDS, STEPPED = "play from, up to here", "previous, next scan"
SIDES = "front, side, back, top"
KEYED = "add, remove a camera key"
SIZED = "smaller, larger points"
ORGANS = "next, previous organ"
WIPED = "move the wipe"
UNDONE = "undo, redo a correction"
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
    "space": "Space",
    "left": "←",
    "right": "→",
    "up": "↑",
    "down": "↓",
    "page_up": "PgUp",
    "page_down": "PgDn",
    "escape": "Esc",
    "home": "Home",
    "tab": "Tab",
    "end": "End",
    "-": "−",
}


@dataclass(frozen=True)
class Action:
    """Something that keys, and perhaps a button on the screen, do to the scene."""

    name: str
    section: str
    keys: tuple[str, ...]  #: any of them does it
    help: str  #: what it does, in a few words
    do: Callable[[Scene], Scene]
    #: the line of help that it shares with its neighbours, if it has no line of its own
    row: str = ""
    repeats: bool = False  #: goes on while the key is held

    @property
    def labels(self) -> tuple[str, ...]:
        """The keys as people read them: "Space", "Shift ←", "G"."""
        return tuple(label(key) for key in self.keys)


def label(key: str) -> str:
    """A key's name as people read it."""
    *modifiers, last = key.split("+") if len(key) > 1 else [key]
    return " ".join([m.capitalize() for m in modifiers] + [_SHOWN.get(last, last.upper())])


_time, _resize = actions.move_time, actions.resize_points

ACTIONS: tuple[Action, ...] = (
    Action("play", "Time", ("space",), "play, pause", _time("toggled")),
    Action("back", "Time", ("left",), "back a little", _time("nudged", -NUDGE), NUDGED, True),
    Action("on", "Time", ("right",), "on a little", _time("nudged", NUDGE), NUDGED, True),
    Action("frame back", "Time", (",",), "one frame back", _time("framed", -1), FRAMED, True),
    Action("frame on", "Time", (".",), "one frame on", _time("framed", 1), FRAMED, True),
    Action(
        "previous", "Time", ("page_up", "shift+left"), "previous scan",
        _time("stepped", -1), STEPPED, True,
    ),
    Action(
        "next", "Time", ("page_down", "shift+right"), "next scan",
        _time("stepped", 1), STEPPED, True,
    ),
    Action("first", "Time", ("home",), "first scan", _time("at", -math.inf), "first, last scan"),
    Action("last", "Time", ("end",), "last scan", _time("at", math.inf), "first, last scan"),
    Action("slower", "Time", ("[", "down"), "slower", _time("slower"), "slower, faster"),
    Action("faster", "Time", ("]", "up"), "faster", _time("faster"), "slower, faster"),
    Action("at end", "Time", ("l",), "loop, back and forth, or stop", actions.AT_END.next),
    Action(
        "begin", "Time", ("i",), "play from here",
        _time("begun_here", notice="Plays from here"), BOUNDS,
    ),
    Action(
        "end", "Time", ("o",), "play up to here",
        _time("ended_here", notice="Plays up to here"), BOUNDS,
    ),
    Action(
        "whole", "Time", ("u",), "play the whole series",
        _time("unbounded", notice="Plays the whole series"),
    ),
    Action("fit", "View", ("f",), "whole plant", actions.go_home),
    Action("front", "View", ("1",), "from the front", actions.look_from(0.0), SIDES),
    Action("side", "View", ("2",), "from the side", actions.look_from(90.0), SIDES),
    Action("behind", "View", ("3",), "from behind", actions.look_from(180.0), SIDES),
    Action("above", "View", ("4",), "from above", actions.look_from(0.0, 90.0), SIDES),
    Action("parallel", "View", ("5",), "perspective or parallel", actions.switch_projection),
    Action(
        "turn", "View", ("t",), "go round the plant",
        lambda s: replace(s, turning=not s.turning, following=False),
    ),
    Action("add key", "View", ("k",), "add a camera key", actions.add_key, KEYED),
    Action("drop key", "View", ("shift+k",), "remove a camera key", actions.remove_key, KEYED),
    Action("follow", "View", ("j",), "follow the camera's path", actions.follow_path),
    Action(
        "save path", "View", ("shift+j",), "save the camera's path",
        actions.wish(Wish.SAVE_PATH),
    ),
    Action("color", "Look", ("c",), "colour by something else", actions.COLOR.next),
    Action("colormap", "Look", ("shift+m",), "other colours of values", actions.COLOR_MAP.next),
    Action("smaller", "Look", ("-",), "smaller points", _resize(1 / STEP), SIZED, True),
    Action("larger", "Look", ("+", "="), "larger points", _resize(STEP), SIZED, True),
    Action(
        "pixels", "Look", ("p",), "points sized in the world or in pixels",
        actions.switch_pixels,
    ),
    Action(
        "ground", "Look", ("g",), "light or dark background",
        lambda s: s.with_style(ground="dark" if s.style.ground == "light" else "light"),
    ),
    Action("floor", "Look", ("b",), "floor and shadow", actions.switch_style("show_ground")),
    Action("depth", "Look", ("d",), "depth cue", actions.switch_style("depth_cue")),
    Action("shading", "Look", ("m",), "shading: none, soft, strong", actions.next_shading),
    Action("guides", "Look", ("a",), "scale bar and axes", actions.switch("guides")),
    Action("legend", "Look", ("y",), "legend", actions.switch("legend")),
    Action("next organ", "Organs", ("n",), "next organ", actions.pick_next(1), ORGANS),
    Action("last organ", "Organs", ("shift+n",), "previous organ", actions.pick_next(-1), ORGANS),
    Action("hide", "Organs", ("x",), "hide the organ", actions.hide_picked),
    Action("curve", "Organs", ("shift+l",), "plot another trait", actions.CURVE.next),
    Action("alone", "Organs", ("z",), "show the organ alone", actions.isolate_picked),
    Action(
        "show all", "Organs", ("shift+x",), "show all organs",
        lambda s: s.with_style(hidden=frozenset(), alone=None),
    ),
    Action("same", "Organs", ("w",), "two organs are the same", actions.correct("same")),
    Action(
        "different", "Organs", ("shift+w",), "two organs are not the same",
        actions.correct("different"),
    ),
    Action("cut", "Organs", ("shift+c",), "cut an organ where clicked", actions.correct("cut")),
    Action("undo", "Organs", ("ctrl+z",), "undo a correction", actions.undo, UNDONE),
    Action("redo", "Organs", ("shift+ctrl+z",), "redo a correction", actions.redo, UNDONE),
    Action("compare", "Compare", ("v",), "with the nearest scan", actions.COMPARE.next),
    Action(
        "wipe left", "Compare", ("<",), "wipe to the left",
        lambda s: actions.wipe_to(s.wipe - 0.05)(s), WIPED, True,
    ),
    Action(
        "wipe right", "Compare", (">",), "wipe to the right",
        lambda s: actions.wipe_to(s.wipe + 0.05)(s), WIPED, True,
    ),
    Action("picture", "Window", ("s",), "save a picture", actions.wish(Wish.PICTURE)),
    Action("export", "Window", ("e",), "export, or stop exporting", actions.wish(Wish.EXPORT)),
    Action("format", "Window", ("shift+e",), "choose what to export", actions.FORMAT.next),
    Action("size", "Window", ("r",), "size of pictures", actions.SIZE.next),
    Action(
        "transparent", "Window", ("shift+s",), "pictures without background",
        actions.switch_transparent,
    ),
    Action("panel", "Window", ("tab",), "panel", actions.switch("panel")),
    Action("fullscreen", "Window", ("f11",), "full screen", actions.switch("fullscreen")),
    Action("help", "Window", ("h", "?", "f1"), "this help", actions.switch("help")),
    Action("leave", "Window", ("escape",), "close, let go, or quit", actions.escape),
    Action("quit", "Window", ("q",), "quit", lambda s: replace(s, closed=True)),
)  # fmt: skip


def action(name: str) -> Action:
    return next(action for action in ACTIONS if action.name == name)


def action_for(key: str) -> Action | None:
    """What a key does, None where it does nothing."""
    return next((action for action in ACTIONS if key in action.keys), None)


def pressed(scene: Scene, key: str, shift: bool = False, repeated: bool = False) -> Scene:
    """A key, by its name or the character typed, went down, or repeats while it is held."""
    found = (action_for(f"shift+{key}") if shift else None) or action_for(key)
    return found.do(scene) if found and (found.repeats or not repeated) else scene


def sections() -> dict[str, list[tuple[tuple[str, ...], str]]]:
    """What to show as help: for each section its rows (key labels, what they do)."""
    table: dict[str, dict[str, list[str]]] = {}
    for entry in ACTIONS:
        beside = {text: [*labels] for text, labels in MOUSE.get(entry.section, {}).items()}
        rows = table.setdefault(entry.section, beside)
        rows.setdefault(entry.row or entry.help, []).extend(entry.labels)
    return {
        section: [(tuple(labels), text) for text, labels in rows.items()]
        for section, rows in table.items()
    }


def help_text() -> str:
    """The table as plain text, for `play --help`."""
    table = sections()
    width = max(len("  ".join(labels)) for rows in table.values() for labels, _ in rows)
    lines = ["Keys and mouse in the window"]
    for section, rows in table.items():
        lines += ["", section]
        lines += [f"  {'  '.join(labels):<{width}}   {text}" for labels, text in rows]
    return "\n".join(lines)
