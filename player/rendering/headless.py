"""Draws pictures of a clip without a screen."""

from typing import Self

import numpy as np
from numpy.typing import NDArray

from gclip import Clip
from player.gl.context import headless
from player.gl.framebuffer import framebuffer
from player.gl.gl_errors import ContextLost, OutOfGpuMemory, check_context, samples_within
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
    """Draw the plant on a day.

    Parameters
    ----------
    clip : gclip.Clip
    day : float
        In the clip's own time.
    size : tuple of int
        Width and height in pixels.
    camera : Camera, optional
        Shows the whole series by default.
    style : Style, optional

    Returns
    -------
    (height, width, 4) uint8 ndarray
        sRGB and alpha, top row first.

    Raises
    ------
    ValueError
        For a day outside the series.
    PlayerError
        Where OpenGL is not available.
    """
    clip.check_day(day)
    with Offscreen(clip, size) as offscreen:
        return offscreen.picture(day, camera, style)


class Offscreen:
    """A renderer with its own context and framebuffer, for any number of pictures."""

    def __init__(self, clip: Clip, size: tuple[int, int], supersample: int = 2) -> None:
        self.clip = clip
        self.size = size
        self._home = Camera.home(clip, size[0] / size[1])
        self._begin(supersample)

    def _begin(self, supersample: int) -> None:
        self.context = headless()
        supersample = samples_within(self.context, self.size, supersample)
        self._framebuffer = framebuffer(self.context, self.size, picture=(4, "f1"))
        self._renderer = Renderer(self.context, self.clip, supersample)

    def picture(
        self,
        day: float,
        camera: Camera | None = None,
        style: Style | None = None,
        transparent: bool = False,
    ) -> NDArray[np.uint8]:
        """Draw a day: (height, width, 4) uint8 sRGB, top row first.

        camera:      shows the whole series by default.
        transparent: draw the plant without a background, with unassociated alpha.
        A driver reset is answered by one new attempt, full GPU memory by one sample a pixel. Raises
        PlayerError if that fails too.
        """
        view = day, camera or self._home, style or Style(), transparent
        try:
            return self._picture(*view)
        except OutOfGpuMemory:
            if self._renderer.supersample == 1:
                raise
            samples = 1
        except ContextLost:
            samples = self._renderer.supersample
        self.release()
        self._begin(samples)
        return self._picture(*view)

    def _picture(
        self, day: float, camera: Camera, style: Style, transparent: bool
    ) -> NDArray[np.uint8]:
        view = day, camera, style, self.size
        self._renderer.draw(self._framebuffer, *view, transparent=transparent)
        pixels = np.frombuffer(self._framebuffer.read(components=4), np.uint8)
        check_context(self.context)
        return pixels.reshape(*self.size[::-1], 4)[::-1]

    def release(self) -> None:
        """Release the context; later calls do nothing."""
        self._renderer.release()
        self.context.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()
