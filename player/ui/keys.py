"""The one table of keys and mouse actions: the handling, the help overlay, `--help`, the buttons
and the panel are made from it.

A key is named as GLFW does, in lower case ("space", "page_up", "f11"), or by the character typed
("?", "+"), which is right on every keyboard layout; "shift+left" asks for the modifier.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import TYPE_CHECKING, Any

import player.export
from player.ui import actions
from player.view.choices import SIZES, Compare, Wish
from player.view.playback import AtEnd, Timeline
from player.view.style import ColorMap

if TYPE_CHECKING:
    from player.view.state import Scene

NUDGE = 0.01  # share of the series that an arrow key goes on
FRAMES = 30  # a second, of the steps from frame to frame
STEP = 1.15  # factor of point sizes
WIPE_STEP = 0.05  # share of the width
SIDES, WIPED = "front, side, back, top", "move the wipe"
# What the mouse does (gui.py), as the help tells it beside the keys.
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
    **{"left": "←", "right": "→", "up": "↑", "down": "↓", "-": "−"},
    **{"page_up": "PgUp", "page_down": "PgDn", "escape": "Esc"},
}


@dataclass(frozen=True)
class Command:
    """Something that keys, and perhaps a control on the screen, do to the scene."""

    name: str
    keys: str  #: any of them does it, with spaces between them
    help: str  #: what it does, in a few words

    @property
    def labels(self) -> tuple[str, ...]:
        """The keys as people read them: "Space", "Shift ←", "G"."""
        return tuple(label(key) for key in self.keys.split())


@dataclass(frozen=True)
class Action(Command):
    """One thing that is done; with `on`, whether it is on, it turns something on and off."""

    do: Callable[[Scene], Scene]
    repeats: bool = False  #: goes on while the key is held
    on: Callable[[Scene], bool] | None = None


@dataclass(frozen=True)
class Choice(Command):
    """One of several values: a key goes on to the next one, and the panel lists them all."""

    label: str
    field: str  #: of the scene, or of a part of it: "curve", "style.color_map"
    values: Callable[[Scene], Sequence[Any]]
    text: Callable[[Any], str] = str  #: of a value, as the panel lists it
    #: why a value can't be chosen, and how it could; "" where it can
    lacking: Callable[[Scene, Any], str] = lambda scene, value: ""
    repeats, on = False, None

    def now(self, scene: Scene) -> Any:
        """What is chosen; the first of the values where that is none of them."""
        values, found = self.values(scene), attrgetter(self.field)(scene)
        return next((value for value in values if value == found), values[0])

    def choose(self, scene: Scene, value: Any) -> Scene:
        if lacking := self.lacking(scene, value):
            return scene.with_notice(lacking[0].upper() + lacking[1:])
        return scene.changed(self.field, value, f"{self.label}: {self.text(value)}")

    def do(self, scene: Scene) -> Scene:
        """Choose the next value that can be chosen, after the last one the first."""
        values = [value for value in self.values(scene) if not self.lacking(scene, value)]
        return self.choose(scene, values[(values.index(self.now(scene)) + 1) % len(values)])


def label(key: str) -> str:
    """A key's name as people read it."""
    *modifiers, last = key.split("+") if len(key) > 1 else [key]
    return " ".join([m.capitalize() for m in modifiers] + [_SHOWN.get(last, last.capitalize())])


def _pair(
    names: str, keys: str, help: str, do: Callable[[Scene, int], Scene], repeats: bool = True
) -> list[Action]:
    """Two directions of one thing: `do` is given -1 for the first of them, and 1 for the other.

    names, keys: of both, with "|" between them.
    """
    return [
        Action(name, key, help, lambda scene, sign=sign: do(scene, sign), repeats)  # type: ignore[misc]
        for name, key, sign in zip(names.split("|"), keys.split("|"), (-1, 1), strict=True)
    ]


def _clock(
    names: str, keys: str, help: str, move: Callable[[Timeline, int], Timeline]
) -> list[Action]:
    """Two directions of the clock."""
    return _pair(names, keys, help, lambda s, sign: s.with_timeline(lambda t: move(t, sign)))


def _switch(name: str, keys: str, help: str, field: str) -> Action:
    """What turns a field of the scene, or of a part of it, on and off."""
    value = attrgetter(field)
    return Action(name, keys, help, lambda scene: scene.changed(field, not value(scene)), on=value)


TABLE: dict[str, tuple[Action | Choice, ...]] = {
    "Time": (
        Action("play", "space", "play, pause", lambda s: s.with_timeline(Timeline.toggled),
               on=lambda s: s.timeline.playing),
        *_clock("back|on", "left|right", "back, on a little",
                lambda t, sign: t.moved(sign * NUDGE * (t.last - t.first))),
        *_clock("frame back|frame on", ",|.", "one frame back, on",
                lambda t, sign: t.moved(sign * t.days_per_second / FRAMES)),
        *_clock("previous|next", "page_up shift+left|page_down shift+right", "previous, next scan",
                Timeline.stepped),
        *_clock("first|last", "home|end", "first, last scan",
                lambda t, sign: t.at(sign * math.inf)),
        *_clock("slower|faster", "[ down|] up", "slower, faster", Timeline.faster),
        Choice("at end", "l", "loop, back and forth, or stop", "At the end", "timeline.at_end",
               lambda s: list(AtEnd)),
    ),
    "View": (
        Action("front", "1", SIDES, lambda s: actions.look_from(s, 0)),
        Action("side", "2", SIDES, lambda s: actions.look_from(s, 90)),
        Action("behind", "3", SIDES, lambda s: actions.look_from(s, 180)),
        Action("above", "4", SIDES, lambda s: actions.look_from(s, 0, 90)),
        Action("fit", "f", "whole plant", actions.go_home),
        Action("parallel", "5", "parallel projection",
               lambda s: s.with_camera(lambda c: c.with_orthographic(not c.orthographic)),
               on=lambda s: s.camera.orthographic),
        _switch("turn", "t", "go round the plant", "turning"),
        Action("follow", "j", "follow the camera's path", actions.follow_path,
               on=lambda s: s.following),
        Action("add key", "k", "add a camera key", lambda s: replace(s, wish=Wish.CAMERA_KEY)),
    ),
    "Look": (
        Choice("color", "c", "colour by something else", "Colour", "style.color_by",
               lambda s: s.color_modes, attrgetter("label"), lambda s, mode: mode.lacking(s.clip)),
        Choice("field", "shift+f", "colour by another field", "Field", "style.field",
               lambda s: s.clip.fields or [""],
               lambda name: name or "none in this clip"),
        Choice("colormap", "shift+m", "other colours of values", "Colours", "style.color_map",
               lambda s: list(ColorMap)),
        *_pair("smaller|larger", "-|+ =", "smaller, larger points",
               lambda s, sign: actions.resize_points(s, STEP**sign)),
        Choice("points", "p", "another size of points", "Points",
               "style.point_size", lambda s: (0.2, 0.5, 1.0, 2.0, 5.0), "{:.0%}".format),
        Choice("shading", "m", "shading: none, soft, strong", "Shading", "style.eye_dome",
               lambda s: (0.0, 1.0, 2.0), "{:.0%}".format),
        Action("ground", "g", "light background",
               lambda s: s.with_style(ground="dark" if s.style.ground == "light" else "light"),
               on=lambda s: s.style.ground == "light"),
        _switch("floor", "b", "floor and shadow", "style.show_ground"),
        _switch("depth", "d", "depth cue", "style.depth_cue"),
        _switch("guides", "a", "scale bar and axes", "guides"),
        _switch("legend", "y", "legend", "legend"),
    ),
    "Organs": (
        *_pair("last organ|next organ", "shift+n|n", "previous, next organ", actions.pick_next),
        Action("hide", "x", "hide the organ", actions.hide_picked),
        Action("show all", "shift+x", "show all organs",
               lambda s: s.with_style(hidden=frozenset(), alone=None)),
        Action("alone", "z", "show the organ alone", actions.isolate_picked,
               on=lambda s: s.style.alone is not None),
        Choice("curve", "shift+l", "plot another trait", "Plot", "curve",
               lambda s: [*s.curves, ""], lambda name: name or "nothing"),
    ),
    "Corrections": (
        Action("same", "w", "two organs are the same", lambda s: actions.correct(s, "same")),
        Action("different", "shift+w", "two organs are not the same",
               lambda s: actions.correct(s, "different")),
        Action("cut", "shift+c", "cut an organ where clicked", lambda s: actions.correct(s, "cut")),
        *_pair("undo|redo", "ctrl+z|shift+ctrl+z", "undo, redo a correction",
               lambda s, sign: replace(s, edits=s.edits and s.edits.moved(sign)), repeats=False),
    ),
    "Compare": (
        Choice("compare", "v", "with the nearest scan", "Compare", "compare",
               lambda s: list(Compare)),
        *_pair("wipe left|wipe right", "<|>", WIPED,
               lambda s, sign: actions.wipe_to(s, s.wipe + sign * WIPE_STEP)),
    ),
    "Export": (
        Choice("format", "shift+e", "choose what to export", "Export", "output.example",
               lambda s: [one.example for one in player.export.FORMATS]),
        Choice("size", "r", "size of pictures", "Pictures", "output.size", lambda s: SIZES,
               lambda size: f"{size[0]} × {size[1]}" if size else "as the window"),
        _switch("transparent", "shift+s", "pictures without background", "output.transparent"),
        Action("export", "e", "export, or stop exporting", lambda s: replace(s, wish=Wish.EXPORT)),
        Action("picture", "s", "save a picture", lambda s: replace(s, wish=Wish.PICTURE)),
    ),
    "Window": (
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
            rows.setdefault(action.help, []).extend(action.labels)
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
