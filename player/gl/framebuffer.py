"""Textures, and the framebuffers that the passes hand on to each other."""

from typing import Any

import moderngl

from player.gl.shader import TILE, Passes

TILE_UNIT = 5  # texture unit of which tiles hold something
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
        The colours, the first of the depths, and the normals.
    mask : moderngl.Framebuffer
        The depth buffer alone.
    filtered : list of moderngl.Framebuffer
        The depths, each alone.
    light : moderngl.Texture
        Light from the plant times cover, and cover; drawn by `lit`.

    The framebuffers share a depth buffer that is 1 where the plant is, and 0 elsewhere.
    """

    def __init__(self, context: moderngl.Context, size: tuple[int, int]) -> None:
        self.size = size
        self.colors = texture(context, size, 4, "f2")
        self.depths = [texture(context, size, 1, "f4") for _ in range(2)]
        self.normals = texture(context, size, 2, "f2")
        self.light = texture(context, size, 4, "f2")
        self._plant = context.depth_renderbuffer(size)
        self._tiles = texture(context, (-(-size[0] // TILE), -(-size[1] // TILE)), 1, "f1")
        self._occupied = context.framebuffer([self._tiles])
        self.framebuffer = context.framebuffer(
            [self.colors, self.depths[0], self.normals], self._plant
        )
        self.mask = context.framebuffer([], self._plant)
        self.filtered = [context.framebuffer([depths], self._plant) for depths in self.depths]
        self.lit = context.framebuffer([self.light], self._plant)
        for framebuffer in (*self.filtered, self.lit):
            framebuffer.depth_mask = False

    def find_tiles(self, passes: Passes, name: str, reach: int, **uniforms: Any) -> None:
        """Find the tiles that hold something; `reach`: how many samples aside a tile looks."""
        self.framebuffer.ctx.enable_only(moderngl.NOTHING)
        self._occupied.use()
        passes.fill(name, reach=reach, **uniforms)

    def fill_tiles(
        self,
        passes: Passes,
        name: str,
        reach: int = 0,
        framebuffer: moderngl.Framebuffer | None = None,
        **uniforms: Any,
    ) -> None:
        """Run a pass that writes depths over the tiles that hold something.

        Parameters
        ----------
        passes : Passes
        name : str
            The fragment shader's.
        reach : int
            How many samples aside it looks.
        framebuffer : moderngl.Framebuffer, optional
            One of the same size, or the G-buffer's own.
        **uniforms
            The shader's.
        """
        target, (across, up) = framebuffer or self.framebuffer, self._tiles.size
        self._tiles.use(TILE_UNIT)
        # OpenGL drops points whose centres lie outside of the viewport: the last tiles' may.
        target.viewport = (0, 0, across * TILE, up * TILE)
        target.use()
        target.ctx.enable_only(moderngl.DEPTH_TEST | moderngl.PROGRAM_POINT_SIZE)
        target.ctx.depth_func = "1"
        passes.fill(name, tiles=across * up, reach=reach, occupied=TILE_UNIT, **uniforms)
        target.viewport = (0, 0, *self.size)

    def clear(self) -> None:
        """No plant anywhere."""
        self.lit.clear()
        self.mask.clear(depth=0.0)
        for depths in self.filtered:
            depths.clear(NOTHING)

    def release(self) -> None:
        framebuffers = (self.framebuffer, self.mask, *self.filtered, self.lit, self._occupied)
        for framebuffer in framebuffers:
            framebuffer.release()
        self._plant.release()
        for attached in (self.colors, *self.depths, self.normals, self.light, self._tiles):
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
    made = context.texture(size, components, dtype=dtype)
    made.filter = (moderngl.LINEAR,) * 2 if linear else (moderngl.NEAREST,) * 2
    made.repeat_x = made.repeat_y = False
    return made
