"""The plant alone, on a transparent ground."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gclip.evaluate import linear_to_srgb, srgb_to_linear

if TYPE_CHECKING:
    from player.rendering.headless import Offscreen
    from player.view.camera import Camera
    from player.view.style import Style

CLEAR, DENSE = 0.02, 0.98  # opacities so near to none or full are eight bits' rounding
FAR_AWAY = 1e3  # scene radii


class Cutout:
    """Draws the plant on black and on grey: what lets the grey through is transparent.

    With the light L of the plant and its opacity a, the picture is L + (1 - a) ground. On black
    that is L; what grey adds to it, over grey itself, is 1 - a (blue-screen matting with two
    screens: Smith and Blinn 1996).
    """

    def __init__(self, offscreen: Offscreen, style: Style) -> None:
        self._offscreen = offscreen
        self._black, self._grey = (
            replace(style, ground=f"{style.ground} on {screen}", show_ground=False)
            for screen in ("black", "grey")
        )
        self._screen: NDArray[np.floating] | None = None

    def picture(self, day: float, camera: Camera) -> NDArray[np.uint8]:
        """(height, width, 4) uint8 sRGB with alpha, not multiplied into the colours."""
        if self._screen is None:
            aside = np.asarray(camera.target) + FAR_AWAY * camera.radius
            x, y, z = aside.tolist()
            self._screen = self._light(day, replace(camera, target=(x, y, z)), self._grey)
        light = self._light(day, camera, self._black)
        through = (self._light(day, camera, self._grey) - light) / self._screen
        opacity = 1.0 - np.clip(through.mean(axis=2), 0.0, 1.0)
        opacity = np.where(opacity < CLEAR, 0.0, np.where(opacity > DENSE, 1.0, opacity))
        color = np.clip(light / np.maximum(opacity, CLEAR)[..., None], 0.0, 1.0)
        cut = np.dstack([linear_to_srgb(color), opacity])
        cut[opacity == 0.0] = 0.0
        return np.round(255.0 * cut).astype(np.uint8)

    def _light(self, day: float, camera: Camera, style: Style) -> NDArray[np.floating]:
        """(height, width, 3) linear light, float32."""
        picture = self._offscreen.picture(day, camera, style)[..., :3]
        return srgb_to_linear(np.arange(256) / 255.0).astype(np.float32)[picture]
