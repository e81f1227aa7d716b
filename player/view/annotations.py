"""What is written over the plant: title, date, scale bar, legend.

One drawing for pictures, films and the window: each brings a `Pen` that knows its fonts and pixels.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib.metadata import distribution
from pathlib import Path
from typing import Protocol

from gclip import Clip, Track
from player.view.camera import Camera
from player.view.colors import ValueRange, format_number
from player.view.dates import date_at, elapsed

LINE, SMALL, LARGE = 23, 15, 21  # height of a line, sizes of letters
MAX_SCALE_BAR = 0.22  # share of the width, for scale bar and ramp
RAMP_WIDTH, RAMP_STEP = 160, 4  # units, and of so many of a ramp's colours one
LEGEND_HEIGHT = 0.62  # share of the height
MAX_NAME = 40  # letters of an organ's name

# Letters and icons: files of imgui-bundle.
REGULAR, BOLD = "Roboto-Regular.ttf", "Roboto-Bold.ttf"
ICONS = "Font_Awesome_6_Free-Solid-900.otf"

RGB = tuple[int, int, int]


@dataclass(frozen=True)
class Annotations:
    """What to write into a picture; a film's title besides."""

    date: bool = False  #: the moment's date and the time since the first scan, below on the left
    #: a bar of a round length, as it appears at the middle of the plant, below on the right
    scale: bool = False
    legend: bool = False  #: what the colours mean, above on the right


class Pen(Protocol):
    """Draws in units of a picture 720 high, from its corners inwards.

    Negative x is counted from the right, and texts end there; negative y from below.
    """

    size: tuple[float, float]  #: width and height of the picture, in units

    def text(
        self, x: float, y: float, text: str, size: float, bold: bool = False, muted: bool = False
    ) -> None:
        """One line, whose corner nearest to the picture's is at (x, y)."""

    def box(self, x: float, y: float, width: float, height: float, color: RGB | None) -> None:
        """A filled box, placed as a text is; None has the text's colour."""


def draw_annotations(
    pen: Pen, wanted: Annotations, day: float, camera: Camera, clip: Clip, ramp: ValueRange | None
) -> None:
    """What is wanted in a picture; ramp: what its legend explains, if not the organs' colours."""
    if wanted.date:
        draw_date(pen, day, clip)
    if wanted.scale:
        draw_scale_bar(pen, camera, clip.unit)
    if wanted.legend:
        draw_organs(pen, clip.track_table) if ramp is None else draw_ramp(pen, ramp)


def draw_date(pen: Pen, day: float, clip: Clip) -> None:
    """Below on the left: the date, and under it the time since the first scan, if that is news."""
    since = elapsed(clip.scans, day, clip.time_unit)
    pen.text(0, -1 - LINE if since else -1, date_at(clip.scans, day), LARGE, bold=True)
    if since:
        pen.text(0, -1, since, SMALL, muted=True)


def draw_scale_bar(pen: Pen, camera: Camera, unit: str) -> None:
    """Below on the right. True at the depth of the camera's target, smaller or larger elsewhere."""
    width, height = pen.size
    units = height / (2.0 * camera.distance * math.tan(camera.field_of_view / 2))
    length = round_length(MAX_SCALE_BAR * width / units)
    bar = length * units
    pen.box(-1, -1, bar, 3, None)
    for end in (-1.0, -1.0 - bar + 2):
        pen.box(end, -1, 2, 10, None)
    pen.text(-1, -16, f"{format_number(length)} {unit or 'units'}", SMALL)


def draw_organs(pen: Pen, tracks: Sequence[Track], room: float = math.inf) -> None:
    """Above on the right: each organ's colour and name, as many as there is room for, in units."""
    rows = max(int(min(LEGEND_HEIGHT * pen.size[1], room) / LINE), 1)
    shown = tracks if len(tracks) <= rows else tracks[: rows - 1]
    for row, track in enumerate(shown):
        y = row * LINE
        pen.box(-1, y + 2, 12, 12, track.color)
        pen.text(-22, y, track.name[:MAX_NAME], SMALL)
    if len(shown) < len(tracks):
        pen.text(-1, len(shown) * LINE, f"and {len(tracks) - len(shown)} more", SMALL, muted=True)


def draw_ramp(pen: Pen, values: ValueRange) -> None:
    """Above on the right: the colours of values, and what the ends of the ramp stand for."""
    pen.text(-1, 0, values.title, SMALL)
    colors = values.colors()[::-RAMP_STEP].tolist()
    step = min(RAMP_WIDTH, MAX_SCALE_BAR * pen.size[0]) / len(colors)
    for place, (red, green, blue) in enumerate(colors):
        pen.box(-1 - place * step, LINE + 2, step + 1, 12, (red, green, blue))
    pen.text(-1, 2 * LINE, " to ".join(values.ends), SMALL, muted=True)


def round_length(longest: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that is no longer than `longest`."""
    power = 10.0 ** math.floor(math.log10(longest))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= longest * (1 + 1e-9))


@cache
def font_file(name: str) -> str:
    """The path of REGULAR, BOLD or ICONS, found without loading imgui-bundle."""
    folder = distribution("imgui-bundle").locate_file("imgui_bundle/assets/fonts")
    return str(next(Path(str(folder)).rglob(name)))
