"""The offscreen pictures that the passes hand on to each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

from player.gl.scissor import Region

if TYPE_CHECKING:
    import moderngl


class Targets:
    """Textures and framebuffers for a picture of `size` = (width, height) pixels.

    A texel is a pixel, and holds the samples of it side by side: most passes need all of them, and
    one look brings them (samples.glsl).

    supersample: samples along each side of a pixel, 1 or 2.
    distances: from the eye, negative where there is nothing; one is smoothed into the other.
    light:     linear light and cover, one texture for each sample.
    mask:      a depth buffer, 0 where the plant is: the later passes run there alone.
    surface:   what rasterisers draw into: the first distances, lights, and mask (leave.glsl).
    smoothed:  the two distances and the mask, which stays.
    """

    def __init__(
        self, context: moderngl.Context, size: tuple[int, int], supersample: int = 1
    ) -> None:
        self.size = size
        self.supersample = supersample
        count = supersample**2
        self.distances = [texture(context, size, count, "f4") for _ in range(2)]
        self.light = [texture(context, size, 4, "f2") for _ in range(count)]
        self.mask = context.depth_renderbuffer(size)
        self.surface = context.framebuffer([self.distances[0], *self.light], self.mask)
        self.smoothed = [context.framebuffer([found], self.mask) for found in self.distances]
        self._drawn: Region | None = None

    def clear(self, region: Region) -> None:
        """No plant anywhere, before one is drawn within a region, of pixels: in the distances and
        in the mask; light counts only where it is.
        """
        cleared = None if self._drawn is None else region.joined(self._drawn).rectangle
        for target, masked in zip(self.smoothed, (True, False), strict=True):
            target.depth_mask = masked
            target.clear(-1.0, -1.0, -1.0, -1.0, viewport=cleared)
            target.depth_mask = False
        self._drawn = region

    def release(self) -> None:
        for framebuffer in (self.surface, *self.smoothed):
            framebuffer.release()
        for found in (*self.distances, *self.light):
            found.release()
        self.mask.release()


def texture(
    context: moderngl.Context,
    size: tuple[int, int],
    components: int,
    kind: str,
    linear: bool = False,
) -> moderngl.Texture:
    """kind: "f1" for bytes, "f2" and "f4" for floats; linear: smooth between texels."""
    import moderngl

    made = context.texture(size, components, dtype=kind)
    made.filter = (moderngl.LINEAR,) * 2 if linear else (moderngl.NEAREST,) * 2
    made.repeat_x = made.repeat_y = False
    return made
