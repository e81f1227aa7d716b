"""The offscreen pictures that the passes hand on to each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import moderngl


class Targets:
    """Textures and framebuffers for a picture of `width` × `height` samples.

    surface:  the nearest surface's depth, then the splats summed upon it.
    gathered: the same surface as dots leave it.
    smoothed: distances from the eye, without the scanner's noise.
    mask:     a depth buffer, 0 where the plant is: the later passes run there alone.
    """

    def __init__(self, context: moderngl.Context, width: int, height: int) -> None:
        size = (width, height)
        self.size = size
        self.color_sum = texture(context, size, 4, "f4")
        self.away_sum = texture(context, size, 1, "f4")
        self.depth = context.depth_renderbuffer(size)
        self.surface = context.framebuffer([self.color_sum, self.away_sum], self.depth)
        self.distances = [texture(context, size, 1, "f4") for _ in range(2)]
        self.mask = context.depth_renderbuffer(size)
        self.smoothed = [context.framebuffer([found], self.mask) for found in self.distances]
        self.smoothed[1].depth_mask = False
        self.gathered = context.framebuffer([self.color_sum, self.distances[0]], self.mask)

    def clear(self) -> None:
        """No plant anywhere: in the distances and in the mask; colours count only where it is."""
        first, second = self.smoothed
        first.depth_mask = True
        first.clear(-1.0)
        first.depth_mask = False
        second.clear(-1.0)

    def release(self) -> None:
        for framebuffer in (self.surface, *self.smoothed, self.gathered):
            framebuffer.release()
        for found in (self.color_sum, self.away_sum, *self.distances):
            found.release()
        self.depth.release()
        self.mask.release()


def texture(
    context: moderngl.Context,
    size: tuple[int, int],
    components: int,
    kind: str,
    linear: bool = False,
) -> moderngl.Texture:
    """kind: "f1" for bytes, "f4" for floats; linear: smooth between texels."""
    import moderngl

    made = context.texture(size, components, dtype=kind)
    made.filter = (moderngl.LINEAR,) * 2 if linear else (moderngl.NEAREST,) * 2
    made.repeat_x = made.repeat_y = False
    return made
