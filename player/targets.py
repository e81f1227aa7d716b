"""The offscreen pictures that the passes hand on to each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import moderngl

GROUND_SHARE = 4  # sides of the picture to sides of the ground's


class Targets:
    """Textures and framebuffers for a picture of `width` × `height` samples.

    surface:  the nearest surface's depth, then the splats summed upon it.
    gathered: the same surface as dots leave it.
    smoothed: distances from the eye, without the scanner's noise.
    mask:     a depth buffer, 0 where the plant is: the later passes run there alone.
    shaded:   the lit plant, premultiplied by its cover.
    ground:   what is behind it; smooth, and so of fewer samples.
    """

    def __init__(self, context: moderngl.Context, width: int, height: int) -> None:
        import moderngl

        size = (width, height)
        self.size = size
        self.color_sum = _texture(context, size, 4, "f4")
        self.away_sum = _texture(context, size, 1, "f4")
        self.depth = context.depth_renderbuffer(size)
        self.surface = context.framebuffer([self.color_sum, self.away_sum], self.depth)
        self.distances = [_texture(context, size, 1, "f4") for _ in range(2)]
        self.mask = context.depth_renderbuffer(size)
        self.smoothed = [context.framebuffer([texture], self.mask) for texture in self.distances]
        for framebuffer in self.smoothed:
            framebuffer.depth_mask = False
        self.gathered = context.framebuffer([self.color_sum, self.distances[0]], self.mask)
        self.light = _texture(context, size, 4, "f2")
        self.shaded = context.framebuffer([self.light], self.mask)
        self.shaded.depth_mask = False
        small = (max(width // GROUND_SHARE, 1), max(height // GROUND_SHARE, 1))
        self.ground_light = _texture(context, small, 4, "f4")
        self.ground_light.filter = (moderngl.LINEAR, moderngl.LINEAR)
        self.ground = context.framebuffer([self.ground_light])

    def release(self) -> None:
        for framebuffer in (self.surface, *self.smoothed, self.gathered, self.shaded, self.ground):
            framebuffer.release()
        for texture in (self.color_sum, self.away_sum, *self.distances, self.light):
            texture.release()
        self.ground_light.release()
        self.depth.release()
        self.mask.release()


def _texture(
    context: moderngl.Context, size: tuple[int, int], components: int, kind: str
) -> moderngl.Texture:
    import moderngl

    texture = context.texture(size, components, dtype=kind)
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    texture.repeat_x = texture.repeat_y = False
    return texture
