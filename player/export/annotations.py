"""What may be written into pictures and films: title, date, scale bar, legend."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from player.errors import PlayerError
from player.view.colors import chosen, worded

if TYPE_CHECKING:
    from gclip import Clip
    from player.export.film import Film
    from player.view.camera import Camera
    from player.view.colors import Scale

REGULAR, BOLD = "Roboto-Regular.ttf", "Roboto-Bold.ttf"
MARGIN, LINE, SMALL, LARGE = 30, 23, 15, 21  # in a picture 720 pixels high
WIDEST_BAR = 0.22  # share of the picture's width, for scale bar and ramp
HALO = 2  # about texts, that they can be read where they lie over the plant
RAMP_WIDTH, RAMP_STEP = 160, 4  # units, and of so many of a ramp's colours one
LEAST_UNIT = 0.6  # pixels: the small text is then 9 of them high
LEGEND_HEIGHT = 0.62  # share of the picture's height


@dataclass(frozen=True)
class Stamps:
    """What to write; the film's title besides.

    date:   the moment's date and the time since the first scan, below on the left.
    scale:  a bar of a round length, as it appears at the middle of the plant, below on the right.
    legend: what the colours mean, above on the right.
    """

    date: bool = False
    scale: bool = False
    legend: bool = False


def check(stamps: Stamps, clip: Clip, film: Film) -> None:
    """Raise PlayerError for a legend of colours that mean nothing: the scans' own."""
    if stamps.legend and chosen(clip, film.style) == "scan":
        raise PlayerError(
            "--legend explains colours of organs and values, not the scans' own; "
            "add --color track, age, speed, height or error, or leave it out."
        )


def stamped(
    picture: NDArray[np.uint8],
    day: float,
    camera: Camera,
    film: Film,
    clip: Clip,
    scale: Scale | None,
) -> NDArray[np.uint8]:
    """The (height, width, 4) picture with the film's title and stamps written upon it.

    scale: of the values whose colours the legend explains, if it is not the organs'.
    """
    from PIL import Image, ImageDraw

    stamps = film.stamps
    if not (film.title or stamps.date or stamps.scale or stamps.legend):
        return picture
    overlay = Image.new("RGBA", film.size, (0, 0, 0, 0))
    pen = _Pen(ImageDraw.Draw(overlay), film)
    if film.title:
        pen.text(0, 0, film.title, LARGE, BOLD)
    if stamps.date:
        _date(pen, day, clip)
    if stamps.scale:
        _scale_bar(pen, camera, clip)
    if stamps.legend:
        _legend(pen, clip) if scale is None else _ramp(pen, scale)
    return np.asarray(Image.alpha_composite(Image.fromarray(picture), overlay))


def bar_length(longest: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that is no longer than `longest`."""
    power = 10.0 ** math.floor(math.log10(longest))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= longest * (1 + 1e-9))


class _Pen:
    """Draws in units of a picture 720 high; corners are counted inwards from the margin.

    Small pictures have larger units, or nobody could read what is written.
    """

    def __init__(self, draw: Any, film: Film) -> None:
        from player.ui.theme import DARK, LIGHT

        self._draw = draw
        self.unit = max(min(film.size) / 720, LEAST_UNIT)
        self.width, self.height = (side / self.unit for side in film.size)
        theme = LIGHT if film.style.ground == "light" else DARK
        self.halo = (255, 255, 255, 120) if theme is LIGHT else (0, 0, 0, 110)
        self.plain, self.muted = (_bytes(color) for color in (theme.text, theme.muted))

    def text(
        self, x: float, y: float, text: str, size: float, font: str = REGULAR, muted: bool = False
    ) -> None:
        """Negative x is counted from the right, and the text ends there; negative y from below."""
        text = "".join(c if c.isprintable() else " " for c in text)
        anchor = ("r" if x < 0 else "l") + ("d" if y < 0 else "a")
        self._draw.text(
            self._at(x, y),
            text,
            fill=self.muted if muted else self.plain,
            font=_font(font, size * self.unit),
            stroke_width=max(round(HALO * self.unit), 1),
            stroke_fill=self.halo,
            anchor=anchor,
        )

    def box(self, x: float, y: float, width: float, height: float, color: tuple) -> None:
        """A filled box whose corner nearest to the picture's is at (x, y)."""
        (x0, y0), wide, high = self._at(x, y), width * self.unit, height * self.unit
        x1, y1 = x0 + (-wide if x < 0 else wide), y0 + (-high if y < 0 else high)
        corners = (*sorted((x0, x1)), *sorted((y0, y1)))
        left, right, top, bottom = (round(side) for side in corners)
        self._draw.rectangle((left, top, max(right - 1, left), max(bottom - 1, top)), fill=color)

    def _at(self, x: float, y: float) -> tuple[float, float]:
        right, below = x < 0, y < 0
        return (
            self.unit * (self.width - MARGIN + x + 1 if right else MARGIN + x),
            self.unit * (self.height - MARGIN + y + 1 if below else MARGIN + y),
        )


def _date(pen: _Pen, day: float, clip: Clip) -> None:
    from player.view.dates import date_at, elapsed

    pen.text(0, -1 - LINE, date_at(clip.scans, day), LARGE, BOLD)
    pen.text(0, -1, elapsed(clip.scans, day, clip.time_unit), SMALL, muted=True)


def _scale_bar(pen: _Pen, camera: Camera, clip: Clip) -> None:
    """True at the depth of the camera's target: nearer parts look larger, farther ones smaller."""
    units = pen.height / (2.0 * camera.distance * math.tan(camera.field_of_view / 2))
    length = bar_length(WIDEST_BAR * pen.width / units)
    width = length * units
    pen.box(-1, -1, width, 3, pen.plain)
    for end in (-1.0, -1.0 - width + 2):
        pen.box(end, -1, 2, 10, pen.plain)
    pen.text(-1, -16, f"{worded(length)} {clip.unit or 'units'}", SMALL)


def _legend(pen: _Pen, clip: Clip) -> None:
    rows = max(int(LEGEND_HEIGHT * pen.height / LINE), 1)
    tracks = clip.track_table if len(clip.track_table) <= rows else clip.track_table[: rows - 1]
    for row, track in enumerate(tracks):
        y = row * LINE
        pen.box(-1, y + 2, 12, 12, (*track.color, 255))
        pen.text(-22, y, track.name[:40], SMALL)
    rest = len(clip.track_table) - len(tracks)
    if rest:
        pen.text(-1, len(tracks) * LINE, f"and {rest} more", SMALL, muted=True)


def _ramp(pen: _Pen, scale: Scale) -> None:
    """The colours of values, lowest first, and what their ends stand for."""
    pen.text(-1, 0, scale.title, SMALL)
    colors = scale.colors()[::-RAMP_STEP]
    step = min(RAMP_WIDTH, WIDEST_BAR * pen.width) / len(colors)
    for place, color in enumerate(colors):
        pen.box(-1 - place * step, LINE + 2, step + 1, 12, (*color.tolist(), 255))
    pen.text(-1, 2 * LINE, " to ".join(scale.ends), SMALL, muted=True)


def _bytes(color: tuple[float, ...]) -> tuple[int, ...]:
    return tuple(round(255 * channel) for channel in color)


@cache
def _font(name: str, size: float) -> Any:
    """The window's own font, found without loading the window; else Pillow's.

    Pillow's basic layout: with libraqm, where the system has that, letters would stand elsewhere.
    """
    from importlib.util import find_spec

    from PIL import ImageFont

    spec = find_spec("imgui_bundle")
    for folder in spec.submodule_search_locations or () if spec else ():
        for path in sorted((Path(folder) / "assets" / "fonts").rglob(name)):
            return ImageFont.truetype(str(path), size, layout_engine=ImageFont.Layout.BASIC)
    return ImageFont.load_default(size)
