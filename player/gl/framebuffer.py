"""Textures, and the framebuffers that one pass writes and the next one reads."""

from functools import cached_property
from typing import Any, cast

import moderngl

from player.gl.gl_errors import pictures_of
from player.gl.shader import Passes

TILE = 16  # side in samples of the tiles by which empty parts of a picture are skipped
NOTHING = 1e4  # relative depth of samples without a point (shaders/depth.glsl)


class GBuffer:
    """Colour, depth and normal of each sample, as the passes over the points write them.

    The depth buffer is 1 on the plant and 0 elsewhere; the passes that follow run only there.

    size:     width and height in samples.
    surface:  colours (linear light and coverage), relative depths (shaders/depth.glsl), normals.
    filtered: depths again, and other depths: filtering writes one from the other and back.
    lit:      the light from the plant times coverage, and coverage.
    """

    def __init__(self, context: moderngl.Context, size: tuple[int, int]) -> None:
        self._context = context
        self.size = size
        self.surface = framebuffer(context, size, (4, "f2"), (1, "f4"), (2, "f2"), deep=True)
        _, depths, _ = textures_of(self.surface)
        plant = self.surface.depth_attachment
        self._mask = context.framebuffer([], plant)
        self.filtered = [
            context.framebuffer([depths], plant),
            framebuffer(context, size, (1, "f4"), depth=plant),
        ]
        self.lit = framebuffer(context, size, (4, "f2"), depth=plant)
        for one in (*self.filtered, self.lit):
            one.depth_mask = False

    @cached_property
    def points(self) -> moderngl.Framebuffer:
        """Number (nearest_point.glsl) and colour of the nearest point in every sample."""
        return framebuffer(self._context, self.size, (1, "u4"), (1, "u4"), deep=True)

    @cached_property
    def tiles(self) -> moderngl.Framebuffer:
        """Which tiles of TILE by TILE samples have points or splats in or near them."""
        width, height = self.size
        return framebuffer(self._context, (-(-width // TILE), -(-height // TILE)), (1, "f1"))

    @cached_property
    def splat_front(self) -> moderngl.Framebuffer:
        """Depth of the splats' nearest surface in every sample."""
        return framebuffer(self._context, self.size, (1, "f4"), deep=True)

    @cached_property
    def splat_sums(self) -> moderngl.Framebuffer:
        """Weighted sums over the splats of that surface; tests depths, and writes none."""
        formats = (4, "f2"), (4, "f2"), (2, "f2")
        depth = self.splat_front.depth_attachment
        sums = framebuffer(self._context, self.size, *formats, depth=depth)
        sums.depth_mask = False
        return sums

    def mark_tiles(self, passes: Passes, name: str, **uniforms: Any) -> None:
        """Run a fragment shader that writes which tiles `fill` runs on."""
        self.tiles.use()
        self._context.enable_only(moderngl.NOTHING)
        passes.fill(name, **uniforms)

    def fill(self, passes: Passes, name: str, **uniforms: Any) -> None:
        """Run a fragment shader that writes the surface and where the plant is."""
        (occupied,) = textures_of(self.tiles)
        self.surface.viewport = (0, 0, *self.size)
        self.surface.use()
        self._context.enable_only(moderngl.DEPTH_TEST)
        self._context.depth_func = "1"
        passes.fill(name, tiles=occupied, **uniforms)

    def clear(self) -> None:
        """Begin a picture without a plant; colours and normals count only where a plant is."""
        self.lit.clear()
        self._mask.clear(depth=0.0)
        for depths in self.filtered:
            depths.clear(NOTHING)


def framebuffer(
    context: moderngl.Context,
    size: tuple[int, int],
    *formats: tuple[int, str],
    deep: bool = False,
    depth: Any = None,
    linear: bool = False,
) -> moderngl.Framebuffer:
    """Create a framebuffer with textures of its own.

    formats: channels and type of each, as `texture` takes them.
    deep:    with a depth buffer; depth: another framebuffer's.
    Raises OutOfGpuMemory where there is no room for it.
    """
    with pictures_of(size):
        textures = [texture(context, size, *format, linear=linear) for format in formats]
        depth = context.depth_renderbuffer(size) if deep else depth
        return context.framebuffer(textures, depth)


def textures_of(framebuffer: moderngl.Framebuffer) -> tuple[moderngl.Texture, ...]:
    """The textures that a framebuffer writes."""
    return cast(tuple[moderngl.Texture, ...], framebuffer.color_attachments)


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
