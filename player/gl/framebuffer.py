"""Textures, and the framebuffers that one pass writes and the next one reads."""

from functools import cached_property, partial
from typing import Any, cast

import moderngl

from player.gl.gl_errors import pictures_of
from player.gl.shader import Passes

TILE = 16  # side in samples of the tiles by which empty parts of a picture are skipped
COLOR, SCALAR, VECTOR = (4, "f2"), (1, "f4"), (2, "f2")  # channels and their type
NOTHING = 1e4  # relative depth of samples without a point (shaders/depth.glsl)


class GBuffer:
    """Colour, depth and normal of each sample, as the passes over the points write them.

    The depth buffer is 1 on the plant and 0 elsewhere; the passes that follow run only there.

    size:     width and height in samples.
    surface:  colours (linear light and coverage), relative depths (shaders/depth.glsl), normals.
    filtered: depths again, and other depths: filtering writes one from the other and back.
    lit:      the light from the plant times coverage, and coverage.
    """

    def __init__(self, context: moderngl.Context, passes: Passes, size: tuple[int, int]) -> None:
        self.passes = passes
        self.size = size
        self._create = partial(framebuffer, context, size)
        self.surface = self._create(colors=COLOR, depths=SCALAR, normals=VECTOR, deep=True)
        plant, depths = self.surface.depth_attachment, textures_of(self.surface)["depths"]
        self._mask = context.framebuffer([], plant)
        self.filtered = [self._create(depths=one, depth=plant) for one in (depths, SCALAR)]
        self.lit = self._create(light=COLOR, depth=plant)
        for tests_only in (*self.filtered, self.lit):
            tests_only.depth_mask = False
        across, down = (-(-side // TILE) for side in size)
        self._tiles = framebuffer(context, (across, down), tiles=(1, "f1"))

    @cached_property
    def points(self) -> moderngl.Framebuffer:
        """Number (nearest_point.glsl) and colour of the nearest point in every sample."""
        return self._create(nearest=(1, "u4"), picked=(1, "u4"), deep=True)

    @cached_property
    def front(self) -> moderngl.Framebuffer:
        """Depth of the splats' nearest surface in every sample."""
        return self._create(front=SCALAR, deep=True)

    @cached_property
    def sums(self) -> moderngl.Framebuffer:
        """Weighted sums over the splats of that surface; tests depths, and writes none."""
        depth = self.front.depth_attachment
        sums = self._create(color_sums=COLOR, moment_sums=COLOR, normal_sums=VECTOR, depth=depth)
        sums.depth_mask = False
        return sums

    def mark_tiles(self, name: str, **uniforms: Any) -> None:
        """Run a fragment shader that writes in which tiles `fill` finds points or splats."""
        draw_into(self._tiles)
        self.passes.fill(name, **uniforms)

    def fill(self, name: str, **uniforms: Any) -> None:
        """Run a fragment shader that writes the surface and where the plant is."""
        self.surface.viewport = (0, 0, *self.size)
        draw_into(self.surface, depth="1")
        self.passes.fill(name, **textures_of(self._tiles), **uniforms)

    def clear(self) -> None:
        """Begin a picture without a plant; colours and normals count only where a plant is."""
        self.lit.clear()
        self._mask.clear(depth=0.0)
        for depths in self.filtered:
            depths.clear(NOTHING)


def draw_into(
    target: moderngl.Framebuffer, *, depth: str = "", blend: tuple[int, int] | None = None
) -> None:
    """Draw into a framebuffer from now on.

    depth: how a depth has to compare with the one that is there, "1" for anyhow; untested if "".
    blend: factors of what is drawn and of what is there; by default it is replaced.
    """
    context = target.ctx
    tests = moderngl.DEPTH_TEST if depth else moderngl.NOTHING
    blends = moderngl.BLEND if blend else moderngl.NOTHING
    context.enable_only(moderngl.PROGRAM_POINT_SIZE | tests | blends)
    context.depth_func = depth or "<"
    context.blend_func = blend or (moderngl.ONE, moderngl.ZERO)
    target.use()


def framebuffer(
    context: moderngl.Context,
    size: tuple[int, int],
    *,
    deep: bool = False,
    depth: Any = None,
    linear: bool = False,
    **textures: tuple[int, str] | moderngl.Texture,
) -> moderngl.Framebuffer:
    """Create a framebuffer.

    deep:     with a depth buffer; depth: another framebuffer's.
    textures: channels and type of each, as `texture` takes them, or one that is there already, by
              the names that shaders read them by.
    Raises OutOfGpuMemory where there is no room for it.
    """
    with pictures_of(size):
        found = {
            name: one if isinstance(one, moderngl.Texture) else texture(context, size, *one, linear)
            for name, one in textures.items()
        }
        depth = context.depth_renderbuffer(size) if deep else depth
        made = context.framebuffer(list(found.values()), depth)
    made.extra = found
    return made


def textures_of(framebuffer: moderngl.Framebuffer) -> dict[str, Any]:
    """The textures that a framebuffer writes, by the names that shaders read them by."""
    return cast(dict[str, Any], framebuffer.extra)


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
