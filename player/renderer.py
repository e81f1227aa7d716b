"""Draws a clip at a time into a framebuffer.

A picture is made in five passes: the depth of the nearest surface; the movers on it summed as soft
discs; light from the depths so found; the shadow on the floor; all put together. A layer that fades
is a cross-fade between the picture without and the picture with it, so that nothing pops.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gclip.evaluate import Layer, layers_at, locate
from player.camera import Camera, axes, outline
from player.closing import ClosingDistances
from player.glsl import give, program
from player.movers import LOOK, Movers
from player.style import GROUNDS, Style
from player.targets import SHADOW_SIDE, ShadowTargets, Targets

if TYPE_CHECKING:
    import moderngl

    from gclip import Clip

DISC = 2.3  # natural disc radius in closing distances: neighbours drift apart between scans
THICKNESS = 1.6  # depth, in disc radii, over which discs count as one surface
SMALLEST = 1.5  # diameter in pixels below which no disc shrinks


class Renderer:
    """Draws one clip with one context.

    supersample: samples along each side of a pixel; 1 in a window, 2 for export.
    """

    def __init__(self, context: moderngl.Context, clip: Clip, supersample: int = 1) -> None:
        self.context = context
        self.clip = clip
        self.supersample = supersample
        self._movers = Movers(context, clip)
        self._closing = ClosingDistances(clip)
        self._targets: Targets | None = None
        self._shadow_targets = ShadowTargets(context)
        self._screen = {
            name: context.vertex_array(program(context, "screen", name, **LOOK), [])
            for name in ("resolve", "smooth", "shade", "blur", "compose")
        }
        points = outline(clip)
        low, high = points.min(axis=0), points.max(axis=0)
        self._middle = (low + high) / 2
        spread = float(np.hypot(*(points[:, :2] - self._middle[:2]).T).max())
        self._floor_side = 1.7 * max(spread, 0.5 * float(high[2] - low[2]), 1e-9)
        self._radius = max(float(np.linalg.norm(high - low)) / 2, 1e-9)

    def draw(
        self,
        framebuffer: moderngl.Framebuffer,
        day: float,
        camera: Camera,
        style: Style,
        size: tuple[int, int],
    ) -> None:
        """Draw the plant on `day` over all of `framebuffer`, `size` = (width, height) pixels.

        The framebuffer stays bound, with blending and depth test switched off.
        """
        targets = self._targets_for(size)
        closing = self._closing.at(*locate(self.clip, day))
        disc = {
            "radius": DISC * style.point_size * closing,
            "magnification": targets.size[1] / (2.0 * math.tan(camera.field_of_view / 2)),
            "smallest": SMALLEST * self.supersample,
        }
        for layers, opacity in _stages(layers_at(self.clip, day)):
            self._draw_surface(targets, layers, camera, style, disc)
            self._shade(targets, camera, style, disc)
            if style.show_ground:
                self._cast_shadow(layers, day, closing)
            self._compose(framebuffer, targets, camera, style, size, opacity)

    def positions(self, day: float) -> NDArray[np.float32]:
        """(N, 3) positions about the clip's origin as the GPU computes them, layer by layer in the
        order of `gclip.evaluate.layers_at`; read back by transform feedback, for tests.
        """
        self._shadow_targets.framebuffers[0].use()
        return self._movers.positions(layers_at(self.clip, day))

    def release(self) -> None:
        """Give the GPU's memory back."""
        self._movers.release()
        self._shadow_targets.release()
        if self._targets is not None:
            self._targets.release()
        for array in self._screen.values():
            array.program.release()
            array.release()

    def _targets_for(self, size: tuple[int, int]) -> Targets:
        samples = (size[0] * self.supersample, size[1] * self.supersample)
        if self._targets is None or self._targets.size != samples:
            if self._targets is not None:
                self._targets.release()
            self._targets = Targets(self.context, *samples)
        return self._targets

    def _draw_surface(
        self,
        targets: Targets,
        layers: list[Layer],
        camera: Camera,
        style: Style,
        disc: dict[str, float],
    ) -> None:
        import moderngl

        context = self.context
        targets.surface.use()
        targets.surface.clear(0.0, 0.0, 0.0, 0.0)
        context.enable_only(moderngl.PROGRAM_POINT_SIZE | moderngl.DEPTH_TEST)
        context.depth_func = "<"
        uniforms = disc | {
            "view": camera.view(),
            "projection": camera.projection(targets.size[0] / targets.size[1]),
            "thickness": THICKNESS,
        }
        targets.surface.color_mask = [(False,) * 4] * 2  # type: ignore[assignment]
        self._movers.draw("surface", layers, uniforms)

        targets.surface.color_mask = [(True,) * 4] * 2  # type: ignore[assignment]
        targets.surface.depth_mask = False
        context.enable(moderngl.BLEND)
        context.blend_func = moderngl.ONE, moderngl.ONE
        self._movers.palette.use(0)
        self._movers.draw(
            "splat", layers, uniforms | {"palette": 0, "by_track": style.color_by == "track"}
        )
        targets.surface.depth_mask = True

    def _shade(
        self, targets: Targets, camera: Camera, style: Style, disc: dict[str, float]
    ) -> None:
        import moderngl

        context, (width, height) = self.context, targets.size
        targets.smoothed[0].depth_mask = True
        targets.smoothed[0].use()
        context.enable_only(moderngl.DEPTH_TEST)
        context.depth_func = "1"
        targets.color_sum.use(0)
        targets.away_sum.use(1)
        self._fill("resolve", color_sum=0, away_sum=1)

        context.depth_func = ">"
        targets.smoothed[0].depth_mask = False
        targets.smoothed[1].clear(-1.0)
        targets.shaded.clear()
        for source, direction in ((0, (1, 0)), (1, (0, 1))):
            targets.smoothed[1 - source].use()
            targets.distances[source].use(1)
            self._fill("smooth", distances=1, direction=direction, **disc)
        targets.shaded.use()
        targets.distances[0].use(1)
        ground = GROUNDS[style.ground]
        up = camera.view()[:3, :3] @ axes(camera.up)[2]
        self._fill(
            "shade",
            color_sum=0,
            distances=1,
            **disc,
            half_field=_half_field(camera, width / height),
            sky=tuple(up),
            scale=self._radius,
            middle=camera.distance,
            dome_radius=max(1.0, 1.2 * height / 720),
            eye_dome=style.eye_dome,
            depth_cue=0.45 if style.depth_cue else 0.0,
            sky_light=ground.sky_light,
            floor_light=ground.floor_light,
            lamp_light=ground.lamp_light,
            haze=ground.haze,
        )

    def _cast_shadow(self, layers: list[Layer], day: float, closing: float) -> None:
        import moderngl

        context, (first, second) = self.context, self._shadow_targets.framebuffers
        first.use()
        first.clear()
        context.enable_only(moderngl.PROGRAM_POINT_SIZE | moderngl.BLEND)
        context.blend_func = moderngl.ONE, moderngl.ONE
        texel = 2.0 * self._floor_side / SHADOW_SIDE
        self._movers.draw(
            "shadow",
            layers,
            {
                "from_above": self._from_above(),
                "reach": 0.12 * self._floor_side,
                "cover": self._mover_area(day, closing) / texel**2,
            },
        )
        context.enable_only(0)
        for target, source, direction in ((second, 0, (1, 0)), (first, 1, (0, 1))):
            target.use()
            self._shadow_targets.textures[source].use(0)
            self._fill(
                "blur",
                source=0,
                direction=(direction[0] / SHADOW_SIDE, direction[1] / SHADOW_SIDE),
                width=(2.0, 9.0),
                saturate=source == 0,
            )

    def _compose(
        self,
        framebuffer: moderngl.Framebuffer,
        targets: Targets,
        camera: Camera,
        style: Style,
        size: tuple[int, int],
        opacity: float,
    ) -> None:
        import moderngl

        framebuffer.viewport = (0, 0, *size)
        framebuffer.use()
        self.context.enable_only(moderngl.BLEND)
        self.context.blend_func = (  # type: ignore[assignment]
            moderngl.SRC_ALPHA,
            moderngl.ONE_MINUS_SRC_ALPHA,
            moderngl.ONE,
            moderngl.ONE,
        )
        targets.light.use(0)
        self._shadow_targets.textures[0].use(1)
        ground = GROUNDS[style.ground]
        self._fill(
            "compose",
            light=0,
            shadow=1,
            supersample=self.supersample,
            half_field=_half_field(camera, size[0] / size[1]),
            to_floor=self._from_above() @ np.linalg.inv(camera.view()),
            floor_share=1.0 if style.show_ground else 0.0,
            above_color=ground.above,
            below_color=ground.below,
            floor_color=ground.floor,
            shadow_color=ground.shadow,
            opacity=opacity,
        )
        self.context.enable_only(0)

    def _fill(self, name: str, **uniforms: Any) -> None:
        give(self._screen[name].program, **uniforms)
        self._screen[name].render(vertices=3)

    def _from_above(self) -> NDArray[np.float64]:
        """(4, 4) from local coordinates to the floor's square, [-1, 1] × [-1, 1] × height."""
        matrix = np.eye(4)
        matrix[:3, :3] = axes(self.clip.up)
        matrix[:3, 3] = -self._middle[0], -self._middle[1], -self.clip.floor
        matrix[:2] /= self._floor_side
        return matrix

    def _mover_area(self, day: float, closing: float) -> float:
        """What one mover covers: the more movers share a scan's surface, the less."""
        index, _ = locate(self.clip, day)
        points = np.interp(day, self.clip.times, [scan.points for scan in self.clip.scans])
        movers = max(len(self.clip.intervals[index]), 1)
        return float(4.0 * closing**2 * points / movers)


def _stages(layers: list[Layer]) -> Iterator[tuple[list[Layer], float]]:
    """What to draw one upon the other: the opaque layers, then these with each fainter one."""
    drawn = [layer for layer in layers if layer.alpha >= 1.0]
    yield drawn, 1.0
    for alpha in sorted({layer.alpha for layer in layers if 0.0 < layer.alpha < 1.0}, reverse=True):
        drawn = drawn + [layer for layer in layers if layer.alpha == alpha]
        yield drawn, alpha


def _half_field(camera: Camera, aspect: float) -> tuple[float, float]:
    slope = math.tan(camera.field_of_view / 2)
    return slope * aspect, slope
