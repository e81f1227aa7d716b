"""Textures, and the framebuffers that one pass writes and the next one reads."""

from functools import cached_property
from typing import Any, NamedTuple

import moderngl

from player.gl.gl_errors import pictures_of
from player.gl.shader import Passes

TILE = 16  # side in samples of the tiles by which empty parts of a picture are skipped
NOTHING = 1e4  # relative depth of samples without a point (shaders/depth.glsl)


class GBuffer:
    """Colour, depth and normal of each sample, as the passes over the points write them.

    The depth buffer is 1 on the plant and 0 elsewhere; the passes that follow run only there.

    size:        width and height in samples.
    depths:      two textures of relative depths (shaders/depth.glsl); filtering writes one from the
                 other and back.
    framebuffer: writes colours (linear light and coverage), the first of the depths, and normals.
    mask:        writes the depth buffer only.
    filtered:    write one of the depths each.
    lit:         writes the light from the plant times coverage, and coverage.
    """

    def __init__(self, context: moderngl.Context, size: tuple[int, int]) -> None:
        self._context = context
        self.size = size
        with pictures_of(size):
            plant = context.depth_renderbuffer(size)
            self.colors = texture(context, size, 4, "f2")
            self.depths = [texture(context, size, 1, "f4") for _ in range(2)]
            self.normals = texture(context, size, 2, "f2")
            self.light = texture(context, size, 4, "f2")
            self.framebuffer = context.framebuffer(
                [self.colors, self.depths[0], self.normals], plant
            )
            self.mask = context.framebuffer([], plant)
            self.filtered = [context.framebuffer([depths], plant) for depths in self.depths]
            self.lit = context.framebuffer([self.light], plant)
        for framebuffer in (*self.filtered, self.lit):
            framebuffer.depth_mask = False

    @cached_property
    def points(self) -> "Target":
        """Number (nearest_point.glsl) and colour of the nearest point in every sample."""
        return target(self._context, self.size, (1, "u4"), (1, "u4"), deep=True)

    @cached_property
    def tiles(self) -> "Target":
        """Which tiles of TILE by TILE samples have points in or near them."""
        width, height = self.size
        return target(self._context, (-(-width // TILE), -(-height // TILE)), (1, "f1"))

    @cached_property
    def splat_front(self) -> "Target":
        """Depth of the splats' nearest surface in every sample."""
        return target(self._context, self.size, (1, "f4"), deep=True)

    @cached_property
    def splat_sums(self) -> "Target":
        """Weighted sums over the splats of that surface; tests depths, and writes none."""
        depth = self.splat_front.framebuffer.depth_attachment
        sums = target(self._context, self.size, (4, "f2"), (4, "f2"), (2, "f2"), depth=depth)
        sums.framebuffer.depth_mask = False
        return sums

    def fill(self, passes: Passes, name: str, **uniforms: Any) -> None:
        """Run a fragment shader that writes colours, depths, normals and where the plant is."""
        self.framebuffer.viewport = (0, 0, *self.size)
        self.framebuffer.use()
        self._context.enable_only(moderngl.DEPTH_TEST)
        self._context.depth_func = "1"
        passes.fill(name, **uniforms)

    def clear(self) -> None:
        """Begin a picture without a plant; colours and normals count only where a plant is."""
        self.lit.clear()
        self.mask.clear(depth=0.0)
        for framebuffer in self.filtered:
            framebuffer.clear(NOTHING)


class Target(NamedTuple):
    """A framebuffer, and the textures that it writes."""

    framebuffer: moderngl.Framebuffer
    textures: list[moderngl.Texture]

    def bind(self, first: int = 0) -> None:
        """Bind the textures to texture units from `first` on."""
        for unit, texture in enumerate(self.textures, start=first):
            texture.use(unit)


def target(
    context: moderngl.Context,
    size: tuple[int, int],
    *formats: tuple[int, str],
    deep: bool = False,
    depth: moderngl.Texture | moderngl.Renderbuffer | None = None,
    linear: bool = False,
) -> Target:
    """Create a framebuffer with textures of its own.

    formats: channels and type of each, as `texture` takes them.
    deep:    with a depth buffer; depth: another framebuffer's.
    Raises OutOfGpuMemory where there is no room for it.
    """
    with pictures_of(size):
        textures = [texture(context, size, *format, linear=linear) for format in formats]
        depth = context.depth_renderbuffer(size) if deep else depth
        return Target(context.framebuffer(textures, depth), textures)


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
