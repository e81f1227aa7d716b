"""Framebuffers and their textures, which one render pass writes and later passes read."""

from functools import cached_property, partial
from typing import Any, cast

import moderngl

from player.gl.gl_errors import OutOfGpuMemory
from player.gl.shader import Passes, Rectangle, Tiles
from shaders import NOTHING

TILE = 16  # side of a tile in samples; passes over the picture skip tiles without points
COLOR, SCALAR, VECTOR = (4, "f2"), (1, "f4"), (2, "f2")  # number and type of channels


class GBuffer:
    """Framebuffers with colour, depth and normal of the nearest surface in each sample.

    Passes are restricted to tiles of the picture with points. In these the common depth buffer is
    1 on the plant and 0 elsewhere, so that the depth test restricts later passes to the plant.

    size:     (width, height) in samples.
    surface:  colours (linear light and coverage), relative depths (shaders/depth.glsl), normals,
              and light from the plant times coverage and coverage, which is 0 at first.
    filtered: two with depths, of which the first shares the texture of `surface`; each filter pass
              reads one and writes the other.
    lit:      the light.
    region:   part of the picture, in tiles, beyond which there are no points.
    """

    def __init__(self, context: moderngl.Context, passes: Passes, size: tuple[int, int]) -> None:
        self.passes = passes
        self.size = size
        self._create = partial(framebuffer, context, size)
        self.surface = self._create(
            colors=COLOR, depths=SCALAR, normals=VECTOR, light=COLOR, with_depth=True
        )
        plant, textures = self.surface.depth_attachment, textures_of(self.surface)
        self._depths = self._create(depths=textures["depths"], filtered=SCALAR)
        depths = textures_of(self._depths).values()
        self.filtered = [self._create(depths=kind, depth=plant) for kind in depths]
        self.lit = self._create(light=textures["light"], depth=plant)
        for read_only_depth in (*self.filtered, self.lit):
            read_only_depth.depth_mask = False
        across, down = (-(-side // TILE) for side in size)
        self._rows = framebuffer(context, (across, size[1]), source=(4, "f1"))
        self._tiles = framebuffer(context, (across, down), occupied=(4, "f1"))
        self.region: Rectangle = (0, 0, across, down)

    @cached_property
    def points(self) -> moderngl.Framebuffer:
        """Code (nearest_point.glsl) and packed colour of the nearest point in each sample."""
        return self._create(nearest=(1, "u4"), picked=(1, "u4"), with_depth=True)

    @cached_property
    def ones(self) -> moderngl.Buffer:
        """Content of an empty texture of `points`, since moderngl cannot clear integers."""
        return self.surface.ctx.buffer(b"\xff" * (4 * self.size[0] * self.size[1]))

    @cached_property
    def front(self) -> moderngl.Framebuffer:
        """Relative depth of the nearest surface of splats in each sample."""
        return self._create(front=SCALAR, with_depth=True)

    @cached_property
    def sums(self) -> moderngl.Framebuffer:
        """Weighted sums over the splats of the surface in `front`, whose depth buffer it tests."""
        depth = self.front.depth_attachment
        sums = self._create(color_sums=COLOR, moment_sums=COLOR, normal_sums=VECTOR, depth=depth)
        sums.depth_mask = False
        return sums

    def mark_tiles(self, points: moderngl.Texture, radius_px: int = 0) -> None:
        """Mark tiles with points (sums of splats, or codes) in them or so near in samples."""
        run = partial(self.passes.run, "tiles", RADIUS_PX=radius_px)
        left, bottom, width, height = self.region
        self._rows.viewport = left, bottom * TILE, width, height * TILE
        self._tiles.viewport = self.region
        draw_into(self._rows)
        run(source=points, direction=(1, 0), CODES=int(points.dtype == "u4"))
        draw_into(self._tiles)
        run(**textures_of(self._rows), direction=(0, 1), CODES=0)

    def run(self, name: str, target: moderngl.Framebuffer, *state: Any, **values: Any) -> None:
        """Run a fragment shader in marked tiles of a framebuffer; state: see `draw_into`."""
        draw_into(target, *state)
        self.passes.run(name, self.tiles(TILE), **values)

    def tiles(self, tile_px: int) -> Tiles:
        """The marked tiles, for a framebuffer of so many pixels a tile."""
        return Tiles(textures_of(self._tiles)["occupied"], self.region, tile_px)

    def clear(self) -> None:
        """Clear depths, which are read beside the plant, too; other textures are not."""
        self._depths.clear(NOTHING, NOTHING)


def draw_into(
    target: moderngl.Framebuffer, depth: str = "", blend: tuple[int, int] | None = None
) -> None:
    """Bind a framebuffer, and set depth test and blending for the draw calls that follow.

    depth: depth function, such as "<", or "1" for always; "" disables the depth test.
    blend: source and destination factor; by default fragments replace what was drawn before.
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
    with_depth: bool = False,
    depth: Any = None,
    linear: bool = False,
    **textures: tuple[int, str] | moderngl.Texture,
) -> moderngl.Framebuffer:
    """Create a framebuffer; raises OutOfGpuMemory if it does not fit.

    size:       (width, height) in pixels.
    with_depth: whether to create a depth buffer.
    depth:      depth buffer of another framebuffer to attach instead.
    linear:     whether new textures interpolate between texels.
    textures:   colour attachments by the names of their uniforms in shaders: an existing texture,
                or number and type of the channels of a new one (see `texture`).
    """
    try:
        for name, kind in textures.items():
            if not isinstance(kind, moderngl.Texture):
                textures[name] = texture(context, size, *kind, linear)
        depth = context.depth_renderbuffer(size) if with_depth else depth
        created = context.framebuffer(list(textures.values()), depth)
    except moderngl.Error:
        raise OutOfGpuMemory(
            f"this graphics driver has no room for a picture of {size[0]}x{size[1]}; "
            "ask for a smaller --size."
        ) from None
    created.extra = textures
    return created


def textures_of(framebuffer: moderngl.Framebuffer) -> dict[str, Any]:
    """The colour attachments of a framebuffer by the names of their uniforms in shaders."""
    return cast(dict[str, Any], framebuffer.extra)


def texture(
    context: moderngl.Context,
    size: tuple[int, int],
    components: int,
    dtype: str,
    linear: bool = False,
) -> moderngl.Texture:
    """Create a texture that is clamped at its edges.

    dtype:  "f1" for normalised bytes, "f2" and "f4" for floats, "u4" for unsigned integers.
    linear: whether to interpolate between texels.
    """
    created = context.texture(size, components, dtype=dtype)
    created.filter = (moderngl.LINEAR,) * 2 if linear else (moderngl.NEAREST,) * 2
    created.repeat_x = created.repeat_y = False
    return created
