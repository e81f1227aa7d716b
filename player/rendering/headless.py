"""Pictures of a clip, drawn without a screen."""

from contextlib import AbstractContextManager

import numpy as np
from numpy.typing import NDArray

from gclip import Clip
from player.gl.context import headless
from player.gl.framebuffer import framebuffer
from player.gl.gl_errors import ContextLost, OutOfGpuMemory, check_context, max_supersample
from player.rendering.renderer import Renderer
from player.view.camera import Camera
from player.view.style import Style


def render(
    clip: Clip,
    day: float,
    size: tuple[int, int] = (1280, 720),
    camera: Camera | None = None,
    style: Style | None = None,
) -> NDArray[np.uint8]:
    """Draw a picture of the plant at one time.

    Parameters
    ----------
    clip : gclip.Clip
    day : float
        In the clip's unit of time.
    size : tuple of int
        Width and height in pixels.
    camera : Camera, optional
        By default one that shows the plant at all times of the series.
    style : Style, optional

    Returns
    -------
    (height, width, 4) uint8 ndarray
        sRGB and alpha, top row first.

    Raises
    ------
    ValueError
        If the day is outside the series.
    PlayerError
        If OpenGL is not available.
    """
    clip.check_day(day)
    with Offscreen(clip, size) as offscreen:
        return offscreen.picture(day, camera, style)


class Offscreen(AbstractContextManager["Offscreen"]):
    """A renderer with its own context and framebuffer, for any number of pictures.

    size:        width and height of the pictures in pixels.
    supersample: samples along each side of a pixel; fewer if the GPU's memory is too small.
    """

    def __init__(self, clip: Clip, size: tuple[int, int], supersample: int = 2) -> None:
        self.clip = clip
        self.size = size
        self._home = Camera.home(clip, size[0] / size[1])
        self._create(supersample)

    def _create(self, supersample: int) -> None:
        self.context = headless()
        supersample = max_supersample(self.context, self.size, supersample)
        self._framebuffer = framebuffer(self.context, self.size, picture=(4, "f1"))
        self._renderer = Renderer(self.context, self.clip, supersample)

    def picture(
        self,
        day: float,
        camera: Camera | None = None,
        style: Style | None = None,
        transparent: bool = False,
    ) -> NDArray[np.uint8]:
        """Draw one picture as `render` does: (height, width, 4) uint8 sRGB, top row first.

        With `transparent` there is no background, and alpha is unassociated. After a driver reset
        drawing is tried once more, and with one sample per pixel if the GPU's memory is full.
        Raises PlayerError if this second attempt fails.
        """
        arguments = day, camera or self._home, style or Style(), transparent
        try:
            return self._picture(*arguments)
        except OutOfGpuMemory:
            if self._renderer.supersample == 1:
                raise
            supersample = 1
        except ContextLost:
            supersample = self._renderer.supersample
        self.release()
        self._create(supersample)
        return self._picture(*arguments)

    def _picture(
        self, day: float, camera: Camera, style: Style, transparent: bool
    ) -> NDArray[np.uint8]:
        target = self._framebuffer
        self._renderer.draw(target, day, camera, style, self.size, transparent=transparent)
        pixels = np.frombuffer(self._framebuffer.read(components=4), np.uint8)
        check_context(self.context)
        return pixels.reshape(*self.size[::-1], 4)[::-1]

    def release(self) -> None:
        """Release the context and everything in it."""
        self._renderer.release()
        self.context.release()

    def __exit__(self, *_: object) -> None:
        self.release()
