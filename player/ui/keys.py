"""The table of key and mouse actions, from which key handling, help, buttons and panel are derived.

Keys have their GLFW names in lower case ("space", "page_up", "f11"). Characters ("?", "+") are
matched as typed, since their keys differ between keyboard layouts. "shift+left" has a modifier.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import TYPE_CHECKING, Any

import player.export
from player.ui import actions
from player.view.choices import PICTURE_SIZES, Compare, Request
from player.view.playback import AtEnd, Timeline
from player.view.style import ColorMap
from shaders.effects import EFFECTS, Effect

if TYPE_CHECKING:
    from player.view.state import Scene

NUDGE = 0.01  # share of the series that an arrow key moves the clock by
FRAME_RATE = 30  # frames per second of the keys that step from frame to frame
SIZE_STEP = 1.15  # factor between sizes of points
WIPE_STEP = 0.05  # share of the width that a key moves the wipe by
SIDES, WIPED = "front, side, back, top", "move the wipe"  # help of several actions
# Mouse actions (gui.py) by the sections of TABLE, as they are listed in the help.
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
_LABELS = {
    **{"left": "←", "right": "→", "up": "↑", "down": "↓", "-": "−"},
    **{"page_up": "PgUp", "page_down": "PgDn", "escape": "Esc"},
}


@dataclass(frozen=True)
class Command:
    """A change of the scene that has keys, and perhaps a button or a control of the panel."""

    name: str
    keys: str  #: alternative keys, separated by spaces
    help: str  #: short description of the effect

    @property
    def labels(self) -> tuple[str, ...]:
        """Labels of the keys for users: "Space", "Shift ←", "G"."""
        return tuple(label(key) for key in self.keys.split())


@dataclass(frozen=True)
class Action(Command):
    """A function from scenes to scenes; with `on` it is a switch, and `on` returns its state."""

    do: Callable[[Scene], Scene]
    repeats: bool = False  #: whether holding the key repeats the action
    on: Callable[[Scene], bool] | None = None


@dataclass(frozen=True)
class Choice(Command):
    """A selection of one of several values: keys select the next one, the panel lists them all."""

    label: str
    field: str  #: path of the field in the scene, such as "curve" or "style.color_map"
    values: Callable[[Scene], Sequence[Any]]
    text: Callable[[Any], str] = str  #: formats a value for the panel
    #: the reason why a value cannot be selected, or ""
    why_unavailable: Callable[[Scene, Any], str] = lambda scene, value: ""
    repeats, on = False, None

    def current(self, scene: Scene) -> Any:
        """The selected value; the first one if the field has none of them."""
        values, selected = self.values(scene), attrgetter(self.field)(scene)
        return next((value for value in values if value == selected), values[0])

    def choose(self, scene: Scene, value: Any) -> Scene:
        if reason := self.why_unavailable(scene, value):
            return scene.with_notice(reason[0].upper() + reason[1:])
        return scene.changed(self.field, value, f"{self.label}: {self.text(value)}")

    def do(self, scene: Scene) -> Scene:
        """Select the next available value; after the last one, the first."""
        values = [value for value in self.values(scene) if not self.why_unavailable(scene, value)]
        return self.choose(scene, values[(values.index(self.current(scene)) + 1) % len(values)])


def label(key: str) -> str:
    """The label of a key for users."""
    *modifiers, last = key.split("+") if len(key) > 1 else [key]
    return " ".join([m.capitalize() for m in modifiers] + [_LABELS.get(last, last.capitalize())])


def _pair(
    names: str, keys: str, help: str, do: Callable[[Scene, int], Scene], repeats: bool = True
) -> list[Action]:
    """Two actions of opposite directions: `do` receives -1 for the first and 1 for the second.

    names, keys: of both actions, separated by "|".
    """
    return [
        Action(name, key, help, lambda scene, sign=sign: do(scene, sign), repeats)  # type: ignore[misc]
        for name, key, sign in zip(names.split("|"), keys.split("|"), (-1, 1), strict=True)
    ]


def _clock(
    names: str, keys: str, help: str, move: Callable[[Timeline, int], Timeline]
) -> list[Action]:
    """Two actions that move the clock in opposite directions."""
    return _pair(names, keys, help, lambda s, sign: s.with_timeline(lambda t: move(t, sign)))


def _toggle(name: str, keys: str, help: str, field: str) -> Action:
    """An action that inverts a boolean field of the scene, given by its path."""
    value = attrgetter(field)
    return Action(name, keys, help, lambda scene: scene.changed(field, not value(scene)), on=value)


def _control(effect: Effect) -> Action | Choice:
    """The control of an effect: a switch, or a choice of a strength."""
    name, key, text, path = effect.name, effect.key, effect.text, f"style.{effect.name}"
    if effect.is_switch:
        return _toggle(name, key, text, path)
    return Choice(name, key, text, effect.label, path, lambda s: effect.steps, "{:.0%}".format)


TABLE: dict[str, tuple[Action | Choice, ...]] = {
    "Time": (
        Action("play", "space", "play, pause", lambda s: s.with_timeline(Timeline.toggled),
               on=lambda s: s.timeline.playing),
        *_clock("back|on", "left|right", "back, on a little",
                lambda t, sign: t.moved(sign * NUDGE * (t.last - t.first))),
        *_clock("frame back|frame on", ",|.", "one frame back, on",
                lambda t, sign: t.moved(sign * t.days_per_second / FRAME_RATE)),
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
        _toggle("turn", "t", "go round the plant", "turning"),
        Action("follow", "j", "follow the camera's path", actions.follow_path,
               on=lambda s: s.following),
        Action("add key", "k", "add a camera key",
               lambda s: replace(s, request=Request.CAMERA_KEY)),
    ),
    "Look": (
        Choice("color", "c", "colour by something else", "Colour", "style.color_by",
               lambda s: s.color_modes, attrgetter("label"),
               lambda s, mode: mode.quantity.why_unavailable(s.clip)),
        Choice("field", "shift+f", "colour by another field", "Field", "style.field",
               lambda s: s.clip.fields or [""], lambda name: name or "none in this clip"),
        Choice("colormap", "shift+m", "other colours of values", "Colour map", "style.color_map",
               lambda s: list(ColorMap)),
        *_pair("smaller|larger", "-|+ =", "smaller, larger points",
               lambda s, sign: actions.resize_points(s, SIZE_STEP**sign)),
        Choice("points", "p", "another size of points", "Points",
               "style.point_size", lambda s: (0.2, 0.5, 1.0, 2.0, 5.0), "{:.0%}".format),
        *(_control(effect) for effect in EFFECTS if not effect.is_switch),
        Action("ground", "g", "light background",
               lambda s: s.with_style(ground="dark" if s.style.ground == "light" else "light"),
               on=lambda s: s.style.ground == "light"),
        *(_control(effect) for effect in EFFECTS if effect.is_switch),
        _toggle("guides", "a", "scale bar and axes", "guides"),
        _toggle("legend", "y", "legend", "legend"),
    ),
    "Organs": (
        *_pair("last organ|next organ", "shift+n|n", "previous, next organ", actions.pick_next),
        Action("hide", "x", "hide the organ", actions.hide_picked),
        Action("show all", "shift+x", "show all organs",
               lambda s: s.with_style(hidden=frozenset(), isolated=None)),
        Action("alone", "z", "show the organ alone", actions.isolate_picked,
               on=lambda s: s.style.isolated is not None),
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
        Choice("size", "r", "size of pictures", "Pictures", "output.size", lambda s: PICTURE_SIZES,
               lambda size: f"{size[0]} × {size[1]}" if size else "as the window"),
        _toggle("transparent", "shift+s", "pictures without background", "output.transparent"),
        Action("export", "e", "export, or stop exporting",
               lambda s: replace(s, request=Request.EXPORT)),
        Action("picture", "s", "save a picture", lambda s: replace(s, request=Request.PICTURE)),
    ),
    "Window": (
        _toggle("panel", "tab", "panel", "panel"),
        _toggle("fullscreen", "f11", "full screen", "fullscreen"),
        _toggle("help", "h ? f1", "this help", "help"),
        Action("leave", "escape", "close, let go, or quit", actions.escape),
        Action("quit", "q", "quit", lambda s: replace(s, closed=True)),
    ),
}  # fmt: skip
ACTIONS = {action.name: action for section in TABLE.values() for action in section}
BY_KEY = {key: action for action in ACTIONS.values() for key in action.keys.split()}


def apply_key(scene: Scene, key: str, shift: bool = False, repeated: bool = False) -> Scene:
    """Apply the action of a key that was pressed, or that repeats because it is held."""
    action = (BY_KEY.get(f"shift+{key}") if shift else None) or BY_KEY.get(key)
    return action.do(scene) if action and (action.repeats or not repeated) else scene


def sections() -> dict[str, dict[str, list[str]]]:
    """Contents of the help: for each section the labels of keys by what they do."""
    table = {}
    for section, entries in TABLE.items():
        rows = {text: [*labels] for text, labels in MOUSE.get(section, {}).items()}
        for action in filter(attrgetter("keys"), entries):
            rows.setdefault(action.help, []).extend(action.labels)
        table[section] = rows
    return table


def help_text() -> str:
    """Format the help as plain text, for `play --help`."""
    table = sections()
    width = max(len("  ".join(labels)) for rows in table.values() for labels in rows.values())
    lines = ["Keys and mouse in the window"]
    for section, rows in table.items():
        lines += ["", section]
        lines += [f"  {'  '.join(labels):<{width}}   {text}" for text, labels in rows.items()]
    return "\n".join(lines)
