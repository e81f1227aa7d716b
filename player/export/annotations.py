"""Writes into pictures, with Pillow, what `player.view.annotations` says."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gclip import Clip
from player.view.annotations import BOLD, LARGE, REGULAR, RGB, draw_annotations, font_file
from player.view.camera import Camera
from player.view.colors import ValueRange
from player.view.style import GROUNDS

if TYPE_CHECKING:
    from player.export.film import Film

MARGIN = 30  # units
HALO = 2  # about texts, that they can be read where they lie over the plant
MIN_UNIT = 0.6  # pixels: the small text is then 9 of them high


def annotated(
    picture: NDArray[np.uint8],
    day: float,
    camera: Camera,
    film: Film,
    clip: Clip,
    values: ValueRange | None,
) -> NDArray[np.uint8]:
    """A picture of a film, (height, width, 4) uint8 sRGB, with its title and annotations.

    camera: from where it was seen, for the scale bar; values: what the legend explains, if not the
    organs' colours.
    """
    from PIL import Image, ImageDraw

    wanted = film.annotations
    if not (film.title or wanted.date or wanted.scale or wanted.legend):
        return picture
    overlay = Image.new("RGBA", film.size, (0, 0, 0, 0))
    pen = PillowPen(ImageDraw.Draw(overlay), film)
    pen.text(0, 0, film.title, LARGE, bold=True)
    draw_annotations(pen, wanted, day, camera, clip, values)
    return np.asarray(Image.alpha_composite(Image.fromarray(picture), overlay))


class PillowPen:
    """A `player.view.annotations.Pen`. Small pictures have larger units, or nobody could read."""

    def __init__(self, draw: Any, film: Film) -> None:
        ground = GROUNDS[film.style.ground]
        self._draw = draw
        self._unit = max(min(film.size) / 720, MIN_UNIT)
        self._text, self._muted = ground.text, ground.muted
        self._halo = (255, 255, 255, 120) if film.style.ground == "light" else (0, 0, 0, 110)
        self.size = (film.size[0] / self._unit, film.size[1] / self._unit)

    def text(
        self, x: float, y: float, text: str, size: float, bold: bool = False, muted: bool = False
    ) -> None:
        self._draw.text(
            self._at(x, y),
            "".join(c if c.isprintable() else " " for c in text),
            fill=self._muted if muted else self._text,
            font=_font(BOLD if bold else REGULAR, size * self._unit),
            stroke_width=max(round(HALO * self._unit), 1),
            stroke_fill=self._halo,
            anchor=("r" if x < 0 else "l") + ("d" if y < 0 else "a"),
        )

    def box(self, x: float, y: float, width: float, height: float, color: RGB | None) -> None:
        corner, sides = np.array(self._at(x, y)), self._unit * np.array([width, height])
        opposite = corner + np.where([x < 0, y < 0], -sides, sides)
        first, end = np.round(np.sort([corner, opposite], axis=0)).astype(int)
        box = (*first.tolist(), *np.maximum(end - 1, first).tolist())
        self._draw.rectangle(box, fill=color or self._text)

    def _at(self, x: float, y: float) -> tuple[float, float]:
        width, height = self.size
        return (
            self._unit * (width - MARGIN + x + 1 if x < 0 else MARGIN + x),
            self._unit * (height - MARGIN + y + 1 if y < 0 else MARGIN + y),
        )


@cache
def _font(name: str, size: float) -> Any:
    """The window's own font, in Pillow's basic layout: with libraqm, where the system has that,
    letters would stand elsewhere.
    """
    from PIL import ImageFont

    return ImageFont.truetype(font_file(name), size, layout_engine=ImageFont.Layout.BASIC)
