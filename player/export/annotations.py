"""Annotations of exported pictures, drawn by Pillow."""

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gclip import Clip
from player.view.annotations import BOLD, LARGE_FONT, REGULAR, RGB, Pen, draw_annotations, font_path
from player.view.camera import Camera
from player.view.colors import ValueRange
from player.view.style import GROUNDS

if TYPE_CHECKING:
    from player.export.film import Film

MARGIN = 30  # units between annotations and the picture's edges
HALO_WIDTH = 2  # units of an outline that keeps text legible over the plant
MIN_UNIT = 0.6  # pixels; the small font is then 9 pixels high


def annotated(
    picture: NDArray[np.uint8],
    day: float,
    camera: Camera,
    film: "Film",
    clip: Clip,
    values: ValueRange | None,
) -> NDArray[np.uint8]:
    """Draw title and annotations of a film over a picture, (height, width, 4) uint8 sRGB.

    day, camera: of the picture; values: for a colour bar, None for a legend of the organs.
    """
    from PIL import Image, ImageDraw

    chosen = film.annotations
    if not (film.title or chosen.date or chosen.scale_bar or chosen.legend):
        return picture
    overlay = Image.new("RGBA", film.size, (0, 0, 0, 0))
    pen = PillowPen(ImageDraw.Draw(overlay), film)
    pen.text(0, 0, film.title, LARGE_FONT, bold=True)
    draw_annotations(pen, chosen, day, camera, clip, values)
    return np.asarray(Image.alpha_composite(Image.fromarray(picture), overlay))


class PillowPen(Pen):
    """Draws on a picture by Pillow; MIN_UNIT keeps text legible in small pictures."""

    def __init__(self, draw: Any, film: "Film") -> None:
        ground = GROUNDS[film.style.ground]
        self._draw = draw
        self._unit = max(min(film.size) / 720, MIN_UNIT)
        self._text, self._muted = ground.text, ground.muted
        self._halo = (255, 255, 255, 120) if film.style.ground == "light" else (0, 0, 0, 110)
        self.size = (film.size[0] / self._unit, film.size[1] / self._unit)
        self.insets = (MARGIN, MARGIN, MARGIN, MARGIN)

    def text(
        self, x: float, y: float, text: str, size: float, bold: bool = False, muted: bool = False
    ) -> None:
        self._draw.text(
            self._unit * np.array(self.corner(x, y, 0.0, 0.0)),
            "".join(c if c.isprintable() else " " for c in text),
            fill=self._muted if muted else self._text,
            font=_font(BOLD if bold else REGULAR, size * self._unit),
            stroke_width=max(round(HALO_WIDTH * self._unit), 1),
            stroke_fill=self._halo,
            anchor=("r" if x < 0 else "l") + ("d" if y < 0 else "a"),
        )

    def box(self, x: float, y: float, width: float, height: float, color: RGB | None) -> None:
        corner = self._unit * np.array(self.corner(x, y, 0.0, 0.0))
        sides = self._unit * np.array([width, height])
        opposite = corner + np.where([x < 0, y < 0], -sides, sides)
        first, end = np.round(np.sort([corner, opposite], axis=0)).astype(int)
        box = (*first.tolist(), *np.maximum(end - 1, first).tolist())
        self._draw.rectangle(box, fill=color or self._text)


@cache
def _font(name: str, size: float) -> Any:
    """Load a font, with Pillow's basic layout because only some systems have libraqm."""
    from PIL import ImageFont

    return ImageFont.truetype(font_path(name), size, layout_engine=ImageFont.Layout.BASIC)
