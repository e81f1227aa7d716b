"""Movers as soft discs, wherever they lie between the samples: for discs of some size."""

from __future__ import annotations

from typing import TYPE_CHECKING

from player.glsl import give, program
from player.movers import LOOK, Movers
from player.rasteriser import Discs

if TYPE_CHECKING:
    from player.chunks import Portion
    from player.region import Region
    from player.targets import Targets

NOTHING, EVERYTHING = [(False,) * 4] * 2, [(True,) * 4] * 2


class Splats:
    """Two passes over the movers: the nearest surface's depth, then the sum of the discs on it."""

    def __init__(self, movers: Movers) -> None:
        self._movers = movers
        self._resolve = movers.context.vertex_array(
            program(movers.context, "screen", "resolve", **LOOK), []
        )

    def draw(self, targets: Targets, portions: list[Portion], discs: Discs, region: Region) -> None:
        import moderngl

        context, surface = self._movers.context, targets.surface
        surface.depth_mask = True
        surface.use()
        surface.clear(0.0, 0.0, 0.0, 0.0, viewport=region.rectangle)
        context.enable_only(moderngl.PROGRAM_POINT_SIZE | moderngl.DEPTH_TEST)
        context.depth_func = "<"
        uniforms = discs.uniforms() | {"projection": discs.projection}
        surface.color_mask = NOTHING  # type: ignore[assignment]
        self._movers.draw("surface", portions, uniforms)

        surface.color_mask = EVERYTHING  # type: ignore[assignment]
        surface.depth_mask = False
        context.enable(moderngl.BLEND)
        context.blend_func = moderngl.ONE, moderngl.ONE
        self._movers.palette.use(0)
        self._movers.draw("splat", portions, uniforms | {"palette": 0})

        resolved = targets.smoothed[0]
        resolved.depth_mask, resolved.scissor = True, region.rectangle
        resolved.use()
        context.enable_only(moderngl.DEPTH_TEST)
        context.depth_func = "1"
        targets.color_sum.use(0)
        targets.away_sum.use(1)
        give(self._resolve.program, color_sum=0, away_sum=1)
        self._resolve.render(vertices=3)
        resolved.depth_mask = False
        resolved.scissor = None  # type: ignore[assignment]

    def release(self) -> None:
        self._resolve.program.release()
        self._resolve.release()
