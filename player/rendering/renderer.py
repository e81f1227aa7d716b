"""Draws a clip at a time into a framebuffer.

A picture is made in steps: the nearest surface, by a rasteriser (rasteriser.py); light from its
distances; the plant's shadow on the floor; all put together. A layer that fades is a cross-fade
between the picture without and the picture with it, so that nothing pops.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gclip.evaluate import Layer, layers_at, locate
from gclip.morton import BLOCK
from player.gl.context import on_cpu
from player.gl.framebuffer import Targets
from player.gl.gl_errors import pictures_of
from player.gl.passes import Passes
from player.gl.scissor import Region, corners, seen, spanned
from player.rendering.ground import Backdrop
from player.rendering.point_buffers import Portion
from player.rendering.point_cloud import LOOK, Movers
from player.rendering.points import LARGEST, Dots, Way
from player.rendering.shading import Lighting
from player.rendering.shadow import BLURRED, SIDE, Shadow
from player.rendering.splat_params import Discs
from player.rendering.splat_radius import ClosingDistances
from player.rendering.splats import Splats
from player.rendering.tiled import TiledSplats
from player.view.camera import Camera, axes, outline
from player.view.colors import Colors, ScalarField
from player.view.style import Style

if TYPE_CHECKING:
    import moderngl

    from gclip import Clip

DISC = 2.3  # natural disc radius in closing distances: neighbours drift apart between scans
SPARE = 4.0  # texels of the floor that the plant may leave its sampled outline by
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
        self._dots = Dots(self._movers, way, supersample)
        self._splats = Splats(self._movers, supersample)
        self._tiled = TiledSplats(self._movers, supersample) if on_cpu(context) else None
        self._shadow = Shadow(self._movers)
        self._closing = ClosingDistances(clip)
        self._colors = Colors(clip)
        self._passes = Passes(context, **LOOK, SUPERSAMPLE=supersample)
        self._sized: tuple[()] | tuple[Targets, Lighting, Backdrop] = ()
        points = outline(clip)
        low, high = points.min(axis=0), points.max(axis=0)
        self._middle = (low + high) / 2
        spread = float(np.hypot(*(points[:, :2] - self._middle[:2]).T).max())
        self._floor_side = 1.7 * max(spread, 0.5 * float(high[2] - low[2]), 1e-9)
        self._half_shadow = (high - low)[:2] / 2 + (BLURRED + 2 * SPARE / SIDE) * self._floor_side
        half = (high - low)[:2] / 2 / self._floor_side
        self._above = spanned(0.5 - 0.5 * half, 0.5 + 0.5 * half, (SIDE, SIDE), SPARE)
        self._radius = max(float(np.linalg.norm(high - low)) / 2, 1e-9)
        self._all_bounds: tuple[NDArray, NDArray] | None = None

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
        Returns whether every mover was drawn, as large as it has to be. The framebuffer stays
        bound, with blending and depth test switched off.
        """
        targets, lighting, backdrop = self._targets_for(size)
        portions = self._portions(layers_at(self.clip, day), every, patience)
        samples = (size[0] * self.supersample, size[1] * self.supersample)
        discs = self._discs(day, camera, style, samples, portions, patience is None)
        area = self._mover_area(day, self._closing.at(*locate(self.clip, day), patience is None))
        self._movers.paint(self._colors, day, style)
        region, shadowed = self._plant_region(discs, portions), self._shadow_region(size, camera)
        pixels = region.scaled(size, self.supersample)
        from_above = self._from_above()
        to_floor = from_above @ np.linalg.inv(camera.view())
        framebuffer.viewport = (0, 0, *size)
        for stage, opacity in _stages(portions):
            if style.show_ground:
                self._shadow.cast(stage, from_above, self._floor_side, area, self._above)
            backdrop.draw(lighting.picture, camera, style, self._shadow, to_floor, shadowed)
            targets.clear(pixels)
            self._rasterise(targets, stage, discs, region)
            smoothed = lighting.smooth(discs, pixels)
            lighting.light(discs, style, pixels, self._radius, backdrop.small, smoothed)
            self._show(framebuffer, lighting, opacity)
        if patience is not None:
            self._closing.measure(locate(self.clip, day)[0])
        exact = patience is None or self.settled(day)
        return _missing(portions) == 0 and every == 1 and exact

    def settled(self, day: float) -> bool:
        """Whether the discs' size on a day is known, and not guessed."""
        return self._closing.settled(locate(self.clip, day)[0])

    @property
    def loaded(self) -> int:
        """Bytes of movers brought to the GPU so far; grows."""
        return self._movers.store.loaded

    def positions(self, day: float, computed: bool = False) -> NDArray[np.float32]:
        """(N, 3) positions about the clip's origin as the GPU computes them, layer by layer in the
        order of `gclip.evaluate.layers_at`; read back for tests, from the vertex shaders or from
        the compute shaders.
        """
        self._targets_for((16, 16))[0].surface.use()
        return self._movers.positions(layers_at(self.clip, day), computed)

    def release(self) -> None:
        """Give the GPU's memory back."""
        self._closing.release()
        parts = (self._movers, self._dots, self._splats, self._shadow, self._passes, *self._sized)
        for part in parts:
            part.release()
        if self._tiled is not None:
            self._tiled.release()

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
            by_value=self._colors.scalar_field(style) is not ScalarField.NONE,
        )

    def _portions(self, layers: list[Layer], every: int, patience: float | None) -> list[Portion]:
        wanted = [Portion(layer, layer.group.count, every) for layer in layers]
        if patience is None:
            return wanted
        there = self._movers.store.load(wanted, patience)
        return [replace(portion, count=n) for portion, n in zip(wanted, there, strict=True)]

    def _rasterise(
        self, targets: Targets, stage: list[Portion], discs: Discs, region: Region
    ) -> None:
        if discs.typical_radius <= LARGEST:
            self._dots.draw(targets, stage, discs, region)
        elif self._tiled is None or not self._tiled.draw(targets, stage, discs, region):
            self._splats.draw(targets, stage, discs, region)

    def _targets_for(self, size: tuple[int, int]) -> tuple[Targets, Lighting, Backdrop]:
        if not self._sized or self._sized[0].size != size:
            for part in self._sized:
                part.release()
            self._sized = ()
            with pictures_of(size):
                targets = Targets(self.context, size, self.supersample)
                self._sized = (
                    targets,
                    Lighting(self.context, targets, self._passes),
                    Backdrop(self.context, size, self._passes),
                )
        return self._sized

    def _show(self, framebuffer: moderngl.Framebuffer, lighting: Lighting, opacity: float) -> None:
        import moderngl

        if opacity == 1.0:
            self.context.copy_framebuffer(framebuffer, lighting.picture)
            framebuffer.use()
            self.context.enable_only(moderngl.NOTHING)
            return
        framebuffer.use()
        self.context.enable_only(moderngl.BLEND)
        self.context.blend_func = (  # type: ignore[assignment]
            moderngl.SRC_ALPHA,
            moderngl.ONE_MINUS_SRC_ALPHA,
            moderngl.ONE,
            moderngl.ONE,
        )
        lighting.texture.use(0)
        self._passes.fill("show", {"picture": 0, "opacity": opacity})
        self.context.enable_only(moderngl.NOTHING)

    def _plant_region(self, discs: Discs, portions: list[Portion]) -> Region:
        """The samples that the movers' discs may cover."""
        boxes = [corners(*self._bounds(p.layer.interval)) for p in portions]
        points = np.concatenate(boxes) if boxes else np.zeros((0, 3))
        nearest = discs.camera.near
        away = -(points @ discs.camera.view()[2, :3] + discs.camera.view()[2, 3])
        reach = discs.radius * discs.magnification / max(away.min(initial=1e30), nearest)
        to_clip = discs.projection @ discs.camera.view()
        margin = max(reach, discs.smallest / 2) + 3.0
        return seen(points, to_clip, discs.samples, nearest, margin)

    def _shadow_region(self, size: tuple[int, int], camera: Camera) -> Region:
        """The pixels of the floor that the plant's shadow may reach."""
        square = self._half_shadow * np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])
        points = np.column_stack([self._middle[:2] + square, np.full(4, self.clip.floor)])
        to_clip = camera.matrix(size[0] / size[1])
        return seen(points @ axes(self.clip.up), to_clip, size, camera.near, 1.0)

    def _bounds(self, index: int) -> tuple[NDArray, NDArray]:
        """Lowest and highest corner of an interval's movers."""
        box = self.clip.intervals[index].box
        if box is not None:
            return np.asarray(box.low), np.asarray(box.high)
        if self._all_bounds is None:
            self._all_bounds = self.clip.bounds
        return self._all_bounds

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
