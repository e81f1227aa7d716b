"""Draws a clip at a time into a framebuffer."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from player.camera import Camera
from player.style import Style

if TYPE_CHECKING:
    import moderngl

    from gclip import Clip


class Renderer:
    """Draws one clip with one context.

    supersample: samples along each side of a pixel; 1 in a window, 2 for export.
    """

    def __init__(self, context: moderngl.Context, clip: Clip, supersample: int = 1) -> None:
        raise NotImplementedError

    def draw(
        self,
        framebuffer: moderngl.Framebuffer,
        day: float,
        camera: Camera,
        style: Style,
        size: tuple[int, int],
    ) -> None:
        """Draw the plant on `day` over all of `framebuffer`, `size` = (width, height) pixels.

        The framebuffer stays bound, with blending and depth test switched off.
        """
        raise NotImplementedError

    def positions(self, day: float) -> NDArray[np.float32]:
        """(N, 3) positions about the clip's origin as the GPU computes them, layer by layer in the
        order of `gclip.evaluate.layers_at`; read back by transform feedback, for tests.
        """
        raise NotImplementedError

    def release(self) -> None:
        """Give the GPU's memory back."""
        raise NotImplementedError
