"""Textures, and the framebuffers that the passes hand on to each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import moderngl


NOTHING = 1e4  # the relative depth where no point is (shaders/depth.glsl)


class GBuffer:
    """What the passes over the points leave of each sample, and the filtered depths.

    Parameters
    ----------
    context : moderngl.Context
    size : (int, int)
        Width and height in samples.

    Attributes
    ----------
    colors : moderngl.Texture
        Linear light, and how much of the sample is covered.
    depths : list of moderngl.Texture
        Relative depths (shaders/depth.glsl): one is filtered into the other and back.
    framebuffer : moderngl.Framebuffer
        The colours and the first of the depths.
    filtered : list of moderngl.Framebuffer
        The depths, each alone.
    light : moderngl.Texture
        Light from the plant times cover, and cover; drawn by `lit`.

    The framebuffers share a depth buffer that is 0 where the plant is, and 1 elsewhere.
    """

    def __init__(self, context: moderngl.Context, size: tuple[int, int]) -> None:
        self.size = size
        self.colors = texture(context, size, 4, "f2")
        self.depths = [texture(context, size, 1, "f4") for _ in range(2)]
        self.light = texture(context, size, 4, "f2")
        self._plant = context.depth_renderbuffer(size)
        self.framebuffer = context.framebuffer([self.colors, self.depths[0]], self._plant)
        self.filtered = [context.framebuffer([depths], self._plant) for depths in self.depths]
        self.lit = context.framebuffer([self.light], self._plant)
        for framebuffer in (*self.filtered, self.lit):
            framebuffer.depth_mask = False

    def clear(self) -> None:
        """No plant anywhere."""
        self.lit.depth_mask = True
        self.lit.clear(depth=1.0)
        self.lit.depth_mask = False
        for depths in self.filtered:
            depths.clear(NOTHING)

    def release(self) -> None:
        framebuffers = (self.framebuffer, *self.filtered, self.lit)
        for framebuffer in framebuffers:
            framebuffer.release()
        self._plant.release()
        for attached in (self.colors, *self.depths, self.light):
            attached.release()


def texture(
    context: moderngl.Context,
    size: tuple[int, int],
    components: int,
    dtype: str,
    linear: bool = False,
) -> moderngl.Texture:
    """A texture that ends at its edges.

    dtype: "f1" for bytes, "f2" and "f4" for floats, "u4" for whole numbers.
    linear: smooth between texels.
    """
    import moderngl

    made = context.texture(size, components, dtype=dtype)
    made.filter = (moderngl.LINEAR,) * 2 if linear else (moderngl.NEAREST,) * 2
    made.repeat_x = made.repeat_y = False
    return made
