"""The offscreen pictures that the passes hand on to each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import moderngl

SHADOW_SIDE = 192  # texels along each side of the floor's shadow


class Targets:
    """Textures and framebuffers for a picture of `width` × `height` samples.

    surface:  the nearest surface's depth, then the splats summed upon it.
    smoothed: distances from the eye, without the scanner's noise.
    mask:     a depth buffer, 0 where the plant is: the later passes run there alone.
    shaded:   the lit plant, premultiplied by its cover.
    """

    def __init__(self, context: moderngl.Context, width: int, height: int) -> None:
        size = (width, height)
        self.size = size
        self.color_sum = _texture(context, size, 4, "f4")
        self.away_sum = _texture(context, size, 1, "f4")
        self.depth = context.depth_renderbuffer(size)
        self.surface = context.framebuffer([self.color_sum, self.away_sum], self.depth)
        self.distances = [_texture(context, size, 1, "f4") for _ in range(2)]
        self.mask = context.depth_renderbuffer(size)
        self.smoothed = [context.framebuffer([texture], self.mask) for texture in self.distances]
        self.smoothed[1].depth_mask = False
        self.light = _texture(context, size, 4, "f2")
        self.shaded = context.framebuffer([self.light], self.mask)
        self.shaded.depth_mask = False

    def release(self) -> None:
        for framebuffer in (self.surface, *self.smoothed, self.shaded):
            framebuffer.release()
        for texture in (self.color_sum, self.away_sum, *self.distances, self.light):
            texture.release()
        self.depth.release()
        self.mask.release()


class ShadowTargets:
    """Two squares that the shadow's blur goes to and fro between."""

    def __init__(self, context: moderngl.Context) -> None:
        import moderngl

        side = (SHADOW_SIDE, SHADOW_SIDE)
        self.textures = [_texture(context, side, 2, "f4") for _ in range(2)]
        for texture in self.textures:
            texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        self.framebuffers = [context.framebuffer([texture]) for texture in self.textures]

    def release(self) -> None:
        for framebuffer in self.framebuffers:
            framebuffer.release()
        for texture in self.textures:
            texture.release()


def _texture(
    context: moderngl.Context, size: tuple[int, int], components: int, kind: str
) -> moderngl.Texture:
    import moderngl

    texture = context.texture(size, components, dtype=kind)
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    texture.repeat_x = texture.repeat_y = False
    return texture
