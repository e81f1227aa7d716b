"""Where everything on the screen stands, and what lies under the cursor. No graphics."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

LABEL_SIZE = 15.0  # of the dates under the timeline
BAR = 124.0  # height of the strip at the bottom that holds the timeline
TOP = 80.0  # height of the strip at the top that holds title and buttons
TRACK_ABOVE_EDGE = 50.0
REACH = 18.0  # how far from the timeline's line the cursor still takes hold of it
ABOVE_PLANT, BELOW_PLANT = 68.0, 112.0  # what titles and timeline take from the picture
SNAP = 4.0  # how near to a scan's mark a click means the scan itself
# Widths below which buttons are left out: of speed, of steps, of what keys do as well.
ROOMY, NARROW, TINY = 760.0, 600.0, 460.0
BUTTON, PLAY_BUTTON, GAP = 32.0, 44.0, 4.0
TOP_BUTTONS = (
    "color",
    "smaller",
    "larger",
    "ground",
    "turn",
    "fit",
    "picture",
    "fullscreen",
    "panel",
    "help",
)
TINY_TOP_BUTTONS = ("color", "ground", "fit", "panel", "help")
TIMELINE, PANEL, WIPE = "the timeline", "the panel", "the wipe"  # none is an action's name
PANEL_WIDTH = 272.0
BESIDE_PANEL = 300.0  # the least that it leaves to the plant
LOWEST_PANEL = 200.0  # height below which it takes the whole window's
WIPE_REACH = 9.0  # how far from the wipe's line the cursor still takes hold of it


@dataclass(frozen=True)
class Rectangle:
    x: float
    y: float
    width: float
    height: float

    @property
    def middle(self) -> tuple[float, float]:
        return self.x + self.width / 2, self.y + self.height / 2

    def holds(self, x: float, y: float) -> bool:
        return self.x <= x < self.x + self.width and self.y <= y < self.y + self.height


@dataclass(frozen=True)
class DateLabel:
    """A scan's date under its mark; `x` is the label's middle."""

    scan: int
    text: str
    x: float
    width: float


@dataclass(frozen=True)
class Layout:
    """All positions in the canvas's units, from the top left corner.

    size:    of the window without its panel, where that stands at the right of it.
    times:   the scans' times.
    left, right, line: ends and height of the timeline's line.
    buttons: by the name of the action they do (keys.py).
    labels:  the dates that fit under the timeline, from left to right.
    speed:   where the speed is written, None where there is no room.
    wipe:    where the wipe's line stands, None without one.
    strokes: times between the scans that a click means exactly, too.
    panel:   where the panel is, None without one.
    """

    size: tuple[float, float]
    times: tuple[float, ...]
    left: float
    right: float
    line: float
    buttons: dict[str, Rectangle]
    labels: tuple[DateLabel, ...]
    speed: tuple[float, float] | None
    wipe: float | None = None
    strokes: tuple[float, ...] = ()
    panel: Rectangle | None = None

    @property
    def margin(self) -> float:
        return _margin(self.size[0])

    def x_of(self, day: float) -> float:
        first, last = self.times[0], self.times[-1]
        return self.left + (self.right - self.left) * (day - first) / (last - first)

    def day_at(self, x: float) -> float:
        """The day under the cursor; right at a scan's mark or a stroke, its own."""
        nearest = min((*self.times, *self.strokes), key=lambda time: abs(self.x_of(time) - x))
        if abs(self.x_of(nearest) - x) <= SNAP:
            return nearest
        share = min(max((x - self.left) / (self.right - self.left), 0.0), 1.0)
        return self.times[0] + share * (self.times[-1] - self.times[0])

    def under(self, x: float, y: float) -> str | None:
        """The name of the button there, TIMELINE, PANEL, WIPE, or None for the plant."""
        if x >= self.size[0] or (self.panel is not None and self.panel.holds(x, y)):
            return PANEL
        for name, place in self.buttons.items():
            if place.holds(x, y):
                return name
        along = self.left - REACH / 2 <= x <= self.right + REACH / 2
        if along and abs(y - self.line) <= REACH:
            return TIMELINE
        between = TOP <= y <= self.size[1] - BAR
        on_wipe = self.wipe is not None and abs(x - self.wipe) <= WIPE_REACH
        return WIPE if on_wipe and between else None


def panel_width(width: float, wanted: bool) -> float:
    """What the panel takes from a window's width: nothing where it would leave too little."""
    return PANEL_WIDTH if wanted and stands_beside(width) else 0.0


def stands_beside(width: float) -> bool:
    """Whether a window is wide enough for the panel beside the plant; else it lies over it."""
    return width >= PANEL_WIDTH + BESIDE_PANEL


def panel_place(size: tuple[float, float]) -> Rectangle:
    """Beside the plant; in a narrow window over it, between buttons and timeline."""
    width, height = size
    left = max(width - PANEL_WIDTH, 0.0)
    between = height - TOP - BAR
    if stands_beside(width) or between < LOWEST_PANEL:
        return Rectangle(left, 0.0, width - left, height)
    return Rectangle(left, TOP, width - left, between)


def arrange(
    size: tuple[float, float],
    times: Sequence[float],
    dates: Sequence[str],
    short_dates: Sequence[str],
    measure: Callable[[str, float], float],
) -> Layout:
    """Lay out a window.

    size:    (width, height) in units.
    dates, short_dates: the scans' dates, and what to write where these leave no room.
    measure: the width of a text at a size.
    """
    width, height = size
    margin, line = _margin(width), height - TRACK_ABOVE_EDGE
    buttons: dict[str, Rectangle] = {}
    left = margin
    for name in ("previous", "play", "next") if width >= NARROW else ("play",):
        side = PLAY_BUTTON if name == "play" else BUTTON
        buttons[name] = Rectangle(left, line - side / 2, side, side)
        left += side + GAP
    right = width - margin
    speed = None
    for name in ("at end", "faster", "slower") if width >= ROOMY else ("at end",):
        right -= BUTTON
        buttons[name] = Rectangle(right, line - BUTTON / 2, BUTTON, BUTTON)
        if name == "faster":
            right -= 40.0
            speed = (right + 20.0, line)
    left, right = left + margin, max(right - margin, left + margin + 1.0)
    top_right = width - margin
    for name in reversed(TOP_BUTTONS if width >= TINY else TINY_TOP_BUTTONS):
        top_right -= BUTTON
        buttons[name] = Rectangle(top_right, margin, BUTTON, BUTTON)
        top_right -= GAP
    bare = Layout(size, tuple(times), left, right, line, buttons, (), speed)
    for texts in (dates, short_dates):
        labels = _labels(bare, texts, measure)
        if len(labels) == len(times):
            break
    return Layout(size, tuple(times), left, right, line, buttons, labels, speed)


def _labels(
    layout: Layout, texts: Sequence[str], measure: Callable[[str, float], float]
) -> tuple[DateLabel, ...]:
    """As many dates as fit without touching; the first and the last go before those between."""
    every = [
        _label(layout, scan, text, measure(text, LABEL_SIZE)) for scan, text in enumerate(texts)
    ]
    kept: list[DateLabel] = []
    for label in (every[0], every[-1], *every[1:-1]):
        if all(abs(label.x - other.x) >= (label.width + other.width) / 2 + 12.0 for other in kept):
            kept.append(label)
    return tuple(sorted(kept, key=lambda label: label.scan))


def _label(layout: Layout, scan: int, text: str, width: float) -> DateLabel:
    """Under its mark, but inside the window and clear of the large button beside the line."""
    play = layout.buttons["play"]
    beside = "previous" not in layout.buttons
    least = (play.x + play.width + GAP if beside else 8.0) + width / 2
    most = layout.size[0] - 8.0 - width / 2
    x = max(min(layout.x_of(layout.times[scan]), most), least)
    return DateLabel(scan, text, x, width)


def _margin(width: float) -> float:
    return 24.0 if width >= NARROW else 14.0
