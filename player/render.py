"""One picture of a clip, without a screen."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from player.camera import Camera
from player.style import Style

if TYPE_CHECKING:
    from gclip import Clip


def render(
    clip: Clip,
    day: float,
    size: tuple[int, int] = (1280, 720),
    camera: Camera | None = None,
    style: Style | None = None,
) -> NDArray[np.uint8]:
    """A picture of the plant on `day`: (height, width, 4) uint8 sRGB, top row first.

    size:   (width, height) in pixels.
    camera: where from; None frames the whole series.
    Raises PlayerError where no OpenGL can be had.
    """
    raise NotImplementedError
