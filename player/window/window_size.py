"""The sizes of a window, and where the plant stands in it. No graphics."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from player.ui.layout import ABOVE_PLANT, BELOW_PLANT
from player.view.camera import Camera

if TYPE_CHECKING:
    from gclip import Clip


@dataclass(frozen=True)
class Measures:
    """The sizes of a window, which differ on displays of high density.

    window:      (width, height) in the system's own coordinates, those of the cursor.
    framebuffer: (width, height) in pixels; zero while the window is minimised.
    scale:       pixels in a unit of 1/96 inch (the system's content scale).
    """

    window: tuple[int, int]
    framebuffer: tuple[int, int]
    scale: float

    @property
    def visible(self) -> bool:
        return min(*self.window, *self.framebuffer) > 0

    @property
    def units(self) -> tuple[float, float]:
        """(width, height) in units."""
        return self.framebuffer[0] / self.scale, self.framebuffer[1] / self.scale

    def to_units(self, x: float, y: float) -> tuple[float, float]:
        """From the cursor's coordinates to units."""
        width, height = self.units
        return x * width / self.window[0], y * height / self.window[1]

    def beside(self, aside: float) -> tuple[int, int]:
        """(width, height) in pixels of what is left beside `aside` units."""
        width, height = self.framebuffer
        return max(width - round(aside * self.scale), 1), height


def home_camera(clip: Clip, size: tuple[float, float]) -> Camera:
    """The whole plant in the part of a window that titles and timeline leave free.

    size: (width, height) of the window in units.
    """
    width, height = size
    free = max(height - ABOVE_PLANT - BELOW_PLANT, 0.3 * height)
    camera = Camera.home(clip, width / free).zoom(free / height)
    return camera.pan(0.0, (BELOW_PLANT - ABOVE_PLANT) / 2 / height)
