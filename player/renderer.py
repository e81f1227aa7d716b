"""Draws a clip at a time into a framebuffer.

A picture is made in steps: the nearest surface, by a rasteriser (rasteriser.py); light from its
distances; the plant's shadow on the floor; all put together. A layer that fades is a cross-fade
between the picture without and the picture with it, so that nothing pops.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gclip.evaluate import Layer, layers_at, locate
from gclip.pack import BLOCK
from player.camera import Camera, axes, outline
from player.chunks import Portion
from player.closing import ClosingDistances
from player.colors import Colors, Value
from player.dots import LARGEST, Dots, Way
from player.glsl import give, program
from player.movers import LOOK, Movers
from player.rasteriser import Discs, Rasteriser
from player.shadow import Shadow
from player.splats import Splats
from player.style import GROUNDS, Style
from player.targets import Targets

if TYPE_CHECKING:
    import moderngl

    from gclip import Clip

DISC = 2.3  # natural disc radius in closing distances: neighbours drift apart between scans
SMALLEST = 1.5  # diameter in pixels below which no disc shrinks


class Renderer:
    """Draws one clip with one context.

    supersample: samples along each side of a pixel; 1 in a window, 2 for export.
    way:         how dots get into the picture; AUTO takes the faster way.
    memory:      bytes of the GPU that movers may take up; None asks the driver.
    """

    def __init__(
        self,
        context: moderngl.Context,
        clip: Clip,
        supersample: int = 1,
        *,
        way: Way = Way.AUTO,
        memory: int | None = None,
    ) -> None:
        self.context = context
        self.clip = clip
        self.supersample = supersample
        self._movers = Movers(context, clip, memory)
        self._dots = Dots(self._movers, way)
        self._splats = Splats(self._movers)
        self._shadow = Shadow(self._movers)
        self._closing = ClosingDistances(clip)
        self._colors = Colors(clip)
        self._targets: Targets | None = None
        look = LOOK | {"SUPERSAMPLE": supersample}
        self._screen = {
            name: context.vertex_array(program(context, "screen", name, **look), [])
            for name in ("smooth", "shade", "ground", "compose")
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
        *,
        every: int = 1,
        patience: float | None = None,
    ) -> bool:
        """Draw the plant on `day` over all of `framebuffer`, `size` = (width, height) pixels.

        every:    of so many movers one is drawn, and larger.
        patience: seconds that uploading may take, or as long as it needs (None). Movers that are
                  not on the GPU by then are left out this time.
        Returns whether every mover was drawn. The framebuffer stays bound, with blending and depth
        test switched off.
        """
        targets = self._targets_for(size)
        portions = self._portions(layers_at(self.clip, day), every, patience)
        discs = self._discs(day, camera, style, targets.size, portions, patience is None)
        area = self._mover_area(day, self._closing.at(*locate(self.clip, day), patience is None))
        self._movers.paint(self._colors, day, style)
        for stage, opacity in _stages(portions):
            self._rasteriser(discs).draw(targets, stage, discs)
            self._shade(targets, discs, style)
            if style.show_ground:
                self._shadow.cast(stage, self._from_above(), self._floor_side, area)
            self._compose(framebuffer, targets, camera, style, size, opacity)
        return _missing(portions) == 0 and every == 1

    @property
    def loaded(self) -> int:
        """Bytes of movers brought to the GPU so far; grows."""
        return self._movers.store.loaded

    def positions(self, day: float, computed: bool = False) -> NDArray[np.float32]:
        """(N, 3) positions about the clip's origin as the GPU computes them, layer by layer in the
        order of `gclip.evaluate.layers_at`; read back for tests, from the vertex shaders or from
        the compute shaders.
        """
        self._targets_for((16, 16)).surface.use()
        return self._movers.positions(layers_at(self.clip, day), computed)

    def release(self) -> None:
        """Give the GPU's memory back."""
        self._closing.release()
        for part in (self._movers, self._dots, self._splats, self._shadow, self._targets):
            if part is not None:
                part.release()
        for array in self._screen.values():
            array.program.release()
            array.release()

    def _discs(
        self,
        day: float,
        camera: Camera,
        style: Style,
        samples: tuple[int, int],
        portions: list[Portion],
        wait: bool,
    ) -> Discs:
        """As large as closes the surface between as many points as are drawn."""
        magnification = samples[1] / (2.0 * math.tan(camera.field_of_view / 2))
        natural = self._closing.at(*locate(self.clip, day), wait)
        every = max((portion.every for portion in portions), default=1)
        radius = DISC * style.point_size * natural * math.sqrt(every)
        missing, drawn = _missing(portions), sum(portion.count for portion in portions)
        if missing:
            # Blocks of neighbours are missing. This passes soon: no larger than is drawn fast.
            gaps = math.sqrt(BLOCK * (drawn + missing) / max(drawn, 1))
            radius = max(radius, min(gaps * radius, LARGEST * camera.distance / magnification))
        smallest = SMALLEST * self.supersample
        if style.pixels is not None:
            radius, smallest = 1e-6 * radius, max(style.pixels * samples[1] / 720, smallest)
        return Discs(
            camera=camera,
            samples=samples,
            radius=radius,
            magnification=magnification,
            smallest=smallest,
            by_track=style.color_by in ("track", "age"),
            by_value=self._colors.value(style) is not Value.NONE,
        )

    def _portions(self, layers: list[Layer], every: int, patience: float | None) -> list[Portion]:
        wanted = [Portion(layer, layer.group.count, every) for layer in layers]
        if patience is None:
            return wanted
        there = self._movers.store.load(wanted, patience)
        return [replace(portion, count=n) for portion, n in zip(wanted, there, strict=True)]

    def _rasteriser(self, discs: Discs) -> Rasteriser:
        return self._dots if discs.typical_radius <= LARGEST else self._splats

    def _targets_for(self, size: tuple[int, int]) -> Targets:
        samples = (size[0] * self.supersample, size[1] * self.supersample)
        if self._targets is None or self._targets.size != samples:
            if self._targets is not None:
                self._targets.release()
            self._targets = Targets(self.context, *samples)
        return self._targets

    def _shade(self, targets: Targets, discs: Discs, style: Style) -> None:
        import moderngl

        context, (width, height) = self.context, targets.size
        context.enable_only(moderngl.DEPTH_TEST)
        context.depth_func = ">"
        targets.color_sum.use(0)
        targets.smoothed[1].clear(-1.0)
        targets.shaded.clear()
        camera = discs.camera
        disc = {
            "radius": discs.radius,
            "magnification": discs.magnification,
            "smallest": discs.smallest,
        }
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

        colors = GROUNDS[style.ground]
        self.context.enable_only(0)
        targets.ground.use()
        self._shadow.use(1)
        self._fill(
            "ground",
            shadow=1,
            half_field=_half_field(camera, size[0] / size[1]),
            to_floor=self._from_above() @ np.linalg.inv(camera.view()),
            floor_share=1.0 if style.show_ground else 0.0,
            above_color=colors.above,
            below_color=colors.below,
            floor_color=colors.floor,
            shadow_color=colors.shadow,
        )
        framebuffer.viewport = (0, 0, *size)
        framebuffer.use()
        self.context.enable_only(moderngl.BLEND if opacity < 1.0 else moderngl.NOTHING)
        self.context.blend_func = (  # type: ignore[assignment]
            moderngl.SRC_ALPHA,
            moderngl.ONE_MINUS_SRC_ALPHA,
            moderngl.ONE,
            moderngl.ONE,
        )
        targets.light.use(0)
        targets.ground_light.use(1)
        self._fill("compose", light=0, ground=1, opacity=opacity)
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


def _stages(portions: list[Portion]) -> Iterator[tuple[list[Portion], float]]:
    """What to draw one upon the other: the opaque layers, then these with each fainter one."""
    drawn = [portion for portion in portions if portion.layer.alpha >= 1.0]
    yield drawn, 1.0
    alphas = {portion.layer.alpha for portion in portions if 0.0 < portion.layer.alpha < 1.0}
    for alpha in sorted(alphas, reverse=True):
        drawn = drawn + [portion for portion in portions if portion.layer.alpha == alpha]
        yield drawn, alpha


def _missing(portions: list[Portion]) -> int:
    """Movers that are to be drawn, and are not on the GPU yet."""
    return sum(portion.layer.group.count - portion.count for portion in portions)


def _half_field(camera: Camera, aspect: float) -> tuple[float, float]:
    slope = math.tan(camera.field_of_view / 2)
    return slope * aspect, slope
