"""Textures, and the framebuffers that one pass writes and the next one reads."""

from typing import Any

import moderngl

from player.gl.shader import TILE, Passes

TILE_UNIT = 5  # texture unit of the mask of occupied tiles
NOTHING = 1e4  # relative depth of samples without a point (shaders/depth.glsl)


class GBuffer:
    """Colour, depth and normal of each sample, as the passes over the points write them.

    All framebuffers share a depth buffer that is 1 on the plant and 0 elsewhere.

    size:        width and height in samples.
    colors:      texture of linear light and coverage.
    depths:      two textures of relative depths (shaders/depth.glsl); filtering writes one from the
                 other and back.
    light:       texture of the light from the plant times coverage, and coverage.
    framebuffer: writes colours, the first of the depths, and normals.
    mask:        writes the depth buffer only.
    filtered:    write one of the depths each.
    lit:         writes the light.
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
        """Mark the occupied tiles, including those within `reach` samples of a point."""
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
        """Run the fragment shader `name` on the occupied tiles; it has to write depths.

        reach:       how many samples around its own the shader reads.
        framebuffer: one of the same size; the G-buffer's own by default.
        """
        target, (across, up) = framebuffer or self.framebuffer, self._tiles.size
        self._tiles.use(TILE_UNIT)
        # OpenGL clips points by their centres; those of the last tiles may lie outside the picture.
        target.viewport = (0, 0, across * TILE, up * TILE)
        target.use()
        target.ctx.enable_only(moderngl.DEPTH_TEST | moderngl.PROGRAM_POINT_SIZE)
        target.ctx.depth_func = "1"
        passes.fill(name, tiles=across * up, reach=reach, occupied=TILE_UNIT, **uniforms)
        target.viewport = (0, 0, *self.size)

    def clear(self) -> None:
        """Reset all buffers to a picture without a plant."""
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
    """Create a texture that is clamped at its edges.

    dtype: "f1" for bytes, "f2" and "f4" for floats, "u4" for unsigned integers.
    linear: whether to interpolate between texels.
    """
    made = context.texture(size, components, dtype=dtype)
    made.filter = (moderngl.LINEAR,) * 2 if linear else (moderngl.NEAREST,) * 2
    made.repeat_x = made.repeat_y = False
    return made
