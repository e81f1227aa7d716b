"""Movers as soft discs, wherever they lie between the samples: for discs of some size."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from player.gl.framebuffer import texture
from player.gl.shader import give, program
from player.rendering.point_cloud import LOOK, Movers
from player.rendering.splat_params import Discs

if TYPE_CHECKING:
    import moderngl

    from player.gl.framebuffer import Targets
    from player.gl.scissor import Region
    from player.rendering.point_buffers import Portion

BEYOND = 512  # samples: how far outside of the picture the centres of discs may lie
NOTHING, EVERYTHING = [(False,) * 4] * 2, [(True,) * 4] * 2


class Splats:
    """Two passes over the movers: the nearest surface's depth, then the sum of the discs on it."""

    def __init__(self, movers: Movers, supersample: int = 1) -> None:
        self._movers = movers
        self._supersample = supersample
        self._largest = min(movers.context.info["GL_MAX_VIEWPORT_DIMS"])
        self._sums: SplatSums | None = None
        self._resolve: moderngl.VertexArray | None = None

    def draw(self, targets: Targets, portions: list[Portion], discs: Discs, region: Region) -> None:
        import moderngl

        context, sums = self._movers.context, self._sums_for(discs.samples)
        summing = sums.framebuffer
        summing.depth_mask = True
        summing.use()
        summing.clear(0.0, 0.0, 0.0, 0.0, viewport=region.rectangle)
        context.enable_only(moderngl.PROGRAM_POINT_SIZE | moderngl.DEPTH_TEST)
        context.depth_func = "<"
        # OpenGL drops a point whose centre lies outside of the viewport, however far it reaches.
        width, height = discs.samples
        reach = math.ceil(discs.radius * discs.magnification / discs.camera.near)
        beyond = max(min(reach, BEYOND, (self._largest - max(width, height)) // 2), 0)
        wide, tall = width + 2 * beyond, height + 2 * beyond
        shrunk = np.diag([width / wide, height / tall, 1.0, 1.0])
        uniforms = discs.uniforms() | {"projection": shrunk @ discs.projection}
        summing.viewport = (-beyond, -beyond, wide, tall)
        summing.color_mask = NOTHING  # type: ignore[assignment]
        self._movers.draw("surface", portions, uniforms)

        summing.color_mask = EVERYTHING  # type: ignore[assignment]
        summing.depth_mask = False
        context.enable(moderngl.BLEND)
        context.blend_func = moderngl.ONE, moderngl.ONE
        self._movers.palette.use(0)
        self._movers.draw("splat", portions, uniforms | {"palette": 0})

        summing.viewport = (0, 0, width, height)
        targets.surface.scissor = region.scaled(targets.size, self._supersample).rectangle
        targets.surface.use()
        context.enable_only(moderngl.DEPTH_TEST)
        context.depth_func = "1"
        sums.color.use(0)
        sums.away.use(1)
        if self._resolve is None:
            chosen = LOOK | {"SUPERSAMPLE": self._supersample}
            self._resolve = context.vertex_array(
                program(context, "screen", "resolve", **chosen), []
            )
        give(self._resolve.program, color_sum=0, away_sum=1)
        self._resolve.render(vertices=3)
        targets.surface.scissor = None  # type: ignore[assignment]

    def _sums_for(self, size: tuple[int, int]) -> SplatSums:
        if self._sums is None or self._sums.color.size != size:
            if self._sums is not None:
                self._sums.release()
            self._sums = SplatSums(self._movers.context, size)
        return self._sums

    def release(self) -> None:
        if self._sums is not None:
            self._sums.release()
        if self._resolve is not None:
            self._resolve.program.release()
            self._resolve.release()


class SplatSums:
    """The nearest surface's depth, and the splats summed upon it, for so many samples."""

    def __init__(self, context: moderngl.Context, size: tuple[int, int]) -> None:
        self.color = texture(context, size, 4, "f4")
        self.away = texture(context, size, 1, "f4")
        self._depth = context.depth_renderbuffer(size)
        self.framebuffer = context.framebuffer([self.color, self.away], self._depth)

    def release(self) -> None:
        for part in (self.framebuffer, self.color, self.away, self._depth):
            part.release()
