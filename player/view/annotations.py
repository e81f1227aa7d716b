"""Annotations over the plant: title, date, scale bar, legend.

Pictures, films and the window share this layout; each implements `Pen` with its own text drawing.
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
from traits.dates import date_at, elapsed

LINE_HEIGHT, SMALL_FONT, LARGE_FONT = 23, 15, 21  # units of `Pen`
MAX_BAR_WIDTH = 0.22  # of scale bar and colour bar, as a share of the picture's width
COLOR_BAR_WIDTH = 160  # units
COLOR_BAR_STEP = 4  # every fourth colour of a colour map is drawn
MAX_LEGEND_HEIGHT = 0.62  # share of the picture's height
MAX_NAME_LENGTH = 40  # characters of an organ's name

# Font files of the package imgui-bundle.
REGULAR, BOLD = "Roboto-Regular.ttf", "Roboto-Bold.ttf"
ICONS = "Font_Awesome_6_Free-Solid-900.otf"

RGB = tuple[int, int, int]


@dataclass(frozen=True)
class Annotations:
    """Which annotations to write into a picture, besides the film's title."""

    date: bool = False  #: date and time since the first scan, bottom left
    #: scale bar, bottom right: a round length, true at the depth of the camera's target
    scale_bar: bool = False
    legend: bool = False  #: meaning of the colours, top right


class Pen(Protocol):
    """Draws text and boxes at positions relative to the picture's corners.

    Units are 1/720 of a picture's shorter side, or 1/96 inch in the window. Negative x counts from
    the right edge, and text is then aligned right; negative y counts from the bottom edge.
    """

    size: tuple[float, float]  #: width and height of the picture, in units
    insets: tuple[float, float, float, float]  #: left, top, right and bottom margin, in units

    def text(
        self, x: float, y: float, text: str, size: float, bold: bool = False, muted: bool = False
    ) -> None:
        """Draw a line of text; the corner of it that is nearest to a picture's corner is (x, y)."""

    def box(self, x: float, y: float, width: float, height: float, color: RGB | None) -> None:
        """Draw a filled box, positioned like text; None selects the text's colour."""

    def corner(self, x: float, y: float, width: float, height: float) -> tuple[float, float]:
        """Upper left corner of a box at (x, y), right and down from that of the picture."""
        left, top, right, bottom = self.insets
        return (
            self.size[0] - right + x + 1 - width if x < 0 else left + x,
            self.size[1] - bottom + y + 1 - height if y < 0 else top + y,
        )


def draw_annotations(
    pen: Pen, chosen: Annotations, day: float, camera: Camera, clip: Clip, values: ValueRange | None
) -> None:
    """Draw the chosen annotations; the legend lists the organs if there are no `values`."""
    if chosen.date:
        draw_date(pen, day, clip)
    if chosen.scale_bar:
        draw_scale_bar(pen, camera, clip.unit)
    if chosen.legend:
        draw_organ_legend(pen, clip.track_table) if values is None else draw_color_bar(pen, values)


def draw_date(pen: Pen, day: float, clip: Clip) -> None:
    """Draw the date at the bottom left, and below it the time since the first scan."""
    since = elapsed(clip.scans, day, clip.time_unit)
    y = -1 - LINE_HEIGHT if since else -1
    pen.text(0, y, date_at(clip.scans, day), LARGE_FONT, bold=True)
    if since:
        pen.text(0, -1, since, SMALL_FONT, muted=True)


def draw_scale_bar(pen: Pen, camera: Camera, unit: str) -> None:
    """Draw a bar of a round length at the bottom right, true at the depth of the target.

    unit: name of the clip's unit of length, "" if it is unknown.
    """
    width, height = pen.size
    scale = height / (2.0 * camera.distance * math.tan(camera.field_of_view / 2))
    length = round_length(MAX_BAR_WIDTH * width / scale)
    bar_width = length * scale
    pen.box(-1, -1, bar_width, 3, None)
    for end in (-1.0, -1.0 - bar_width + 2):
        pen.box(end, -1, 2, 10, None)
    pen.text(-1, -16, f"{format_number(length)} {unit or 'units'}", SMALL_FONT)


def draw_organ_legend(pen: Pen, tracks: Sequence[Track], max_height: float = math.inf) -> None:
    """Draw colours and names of organs at the top right, as many as fit into `max_height` units."""
    rows = max(int(min(MAX_LEGEND_HEIGHT * pen.size[1], max_height) / LINE_HEIGHT), 1)
    shown = tracks if len(tracks) <= rows else tracks[: rows - 1]
    for row, track in enumerate(shown):
        y = row * LINE_HEIGHT
        pen.box(-1, y + 2, 12, 12, track.color)
        pen.text(-22, y, track.name[:MAX_NAME_LENGTH], SMALL_FONT)
    if len(shown) < len(tracks):
        more = f"and {len(tracks) - len(shown)} more"
        pen.text(-1, len(shown) * LINE_HEIGHT, more, SMALL_FONT, muted=True)


def draw_color_bar(pen: Pen, values: ValueRange) -> None:
    """Draw the colours of values at the top right, with the values at both ends."""
    pen.text(-1, 0, values.title, SMALL_FONT)
    colors = values.colors()[::-COLOR_BAR_STEP].tolist()
    step = min(COLOR_BAR_WIDTH, MAX_BAR_WIDTH * pen.size[0]) / len(colors)
    for index, (red, green, blue) in enumerate(colors):
        pen.box(-1 - index * step, LINE_HEIGHT + 2, step + 1, 12, (red, green, blue))
    pen.text(-1, 2 * LINE_HEIGHT, " to ".join(values.ends), SMALL_FONT, muted=True)


def round_length(longest: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that is no longer than `longest`."""
    power = 10.0 ** math.floor(math.log10(longest))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= longest * (1 + 1e-9))


@cache
def font_path(name: str) -> str:
    """The path of one of imgui-bundle's fonts, found without importing imgui-bundle."""
    folder = distribution("imgui-bundle").locate_file("imgui_bundle/assets/fonts")
    return str(next(Path(str(folder)).rglob(name)))
