"""Draws a clip at a time into a framebuffer.

A picture is made in steps: the nearest surface's colour and depth, from points of one sample
(points.py) or from splats (splats.py); the depths, filtered; the plant's shadow on the floor; all
lit (shading.py) and put over the ground.
"""

import math
from dataclasses import replace

import moderngl
import numpy as np

from gclip import Clip
from gclip.evaluate import Layer, layers_at, locate
from gclip.morton import BLOCK
from player.gl.framebuffer import GBuffer
from player.gl.gl_errors import pictures_of
from player.gl.shader import Passes
from player.rendering.ground import Ground
from player.rendering.picking import Picking
from player.rendering.point_buffers import DrawRange
from player.rendering.point_cloud import PointCloud
from player.rendering.points import MAX_RADIUS_PX, PointRaster, RasterBackend
from player.rendering.shading import shade, smooth_depths
from player.rendering.splat_radius import ClosingDistances
from player.rendering.splats import ALIGNED, FACING, SplatParams, Splats, SplatShape
from player.view.camera import Camera, outline
from player.view.colors import Colors, ScalarField
from player.view.style import Style

# Of a splat, in closing distances: neighbours drift apart between scans. More splats than close the
# surface have to find its edge together.
NATURAL_RADIUS, ALIGNED_RADIUS = 2.3, 2.6
MIN_POINT_PX = 1.5  # diameter in pixels below which no splat shrinks
SHADOW_UNIT = 2


class Renderer:
    """Draws one clip with one context.

    supersample: samples along each side of a pixel; 1 in a window, 2 for export.
    backend:     what draws small points; None takes compute shaders where there are any.
    memory:      bytes of the GPU that points may take up; None asks the driver.

    Attributes
    ----------
    timers : PassTimers
    gpu_seconds : float
        What the picture before the last one took on the GPU: it is done, asking waits for nothing.
    """

    def __init__(
        self,
        context: moderngl.Context,
        clip: Clip,
        supersample: int = 1,
        *,
        backend: RasterBackend | None = None,
        memory: int | None = None,
    ) -> None:
        self.context = context
        self.clip = clip
        self.supersample = supersample
        self._points = PointCloud(context, clip, memory)
        self.timers = self._points.timers
        self._passes = Passes(context, self.timers, SUPERSAMPLE=supersample)
        self._raster = PointRaster(self._points, self._passes, backend)
        self._splats = Splats(self._points, self._passes)
        self._ground = Ground(self._points, self._passes)
        self._picking = Picking(self._points, self._passes)
        self._closing = ClosingDistances(clip)
        self._colors = Colors(clip)
        self._gbuffer: GBuffer | None = None
        self.gpu_seconds = 0.0
        self._max_point_px = float(context.info["GL_POINT_SIZE_RANGE"][1])
        self._scene_radius = scene_radius(clip)

    def draw(
        self,
        framebuffer: moderngl.Framebuffer,
        day: float,
        camera: Camera,
        style: Style,
        size: tuple[int, int],
        *,
        stride: int = 1,
        upload_budget: float | None = None,
        transparent: bool = False,
    ) -> bool:
        """Draw the plant on `day` over all of a framebuffer.

        Parameters
        ----------
        framebuffer : moderngl.Framebuffer
            Stays bound, with blending and depth test switched off.
        day : float
            In the clip's own time.
        camera : Camera
        style : Style
        size : (int, int)
            The framebuffer's width and height in pixels.
        stride : int
            Of so many points one is drawn, and larger.
        upload_budget : float, optional
            Seconds that uploading may take, or as long as it needs. Points that are not on the GPU
            by then are left out this time.
        transparent : bool
            The plant alone, with alpha, not multiplied into the colours.

        Returns
        -------
        bool
            Whether every point was drawn, as large as it has to be.
        """
        wait = upload_budget is None
        self.gpu_seconds = self.timers.finish_frame()
        samples = (size[0] * self.supersample, size[1] * self.supersample)
        gbuffer = self._gbuffer_of(samples)
        ranges = self._ranges(layers_at(self.clip, day), stride, upload_budget)
        closing = self._closing.at(*locate(self.clip, day), wait)
        splats = self._splat_params(camera, style, samples, ranges, closing)
        self._points.set_colors(self._colors, day, style)
        if style.show_ground and not transparent:
            self._ground.cast_shadow(ranges, self._point_area(day, closing))
        gbuffer.clear()
        are_points = splats.typical_radius_px <= MAX_RADIUS_PX
        (self._raster if are_points else self._splats).draw(gbuffer, ranges, splats)
        smooth_depths(self._passes, gbuffer, splats)
        shade(self._passes, gbuffer, splats, style)
        if not are_points and splats.shape.edge < 1.0:
            self._splats.draw_behind(gbuffer, ranges, splats)
            shade(self._passes, gbuffer, splats, style)
        framebuffer.viewport = (0, 0, *size)
        framebuffer.use()
        gbuffer.light.use(0)
        self._passes.fill(
            "picture",
            **splats.uniforms(),
            **self._ground.uniforms(camera, style, SHADOW_UNIT),
            light=0,
            transparent=transparent,
        )
        if not wait:
            self._closing.measure(locate(self.clip, day)[0])
        return _missing(ranges) == 0 and stride == 1 and (wait or self.radius_known(day))

    def organ_at(
        self,
        day: float,
        camera: Camera,
        style: Style,
        at: tuple[float, float],
        size: tuple[float, float],
    ) -> int | None:
        """The track of the organ that is seen at a place of the picture; None beside the plant.

        Only points that are on the GPU already count, and nothing that lies on the ground.

        Parameters
        ----------
        day : float
        camera : Camera
        style : Style
        at : (float, float)
            The place, from the top left corner.
        size : (float, float)
            The picture's width and height, in the same unit.
        """
        layers = [layer for layer in layers_at(self.clip, day) if not layer.litter]
        ranges = self._ranges(layers, 1, 0.0)
        closing = self._closing.at(*locate(self.clip, day), False)
        samples = (max(round(size[0]), 1), max(round(size[1]), 1))
        splats = self._splat_params(camera, style, samples, ranges, closing)
        self._points.set_colors(self._colors, day, style)
        return self._picking.track_at(ranges, splats, at)

    def radius_known(self, day: float) -> bool:
        """Whether the splats' size on a day is measured, and not guessed."""
        return self._closing.settled(locate(self.clip, day)[0])

    @property
    def loaded(self) -> int:
        """Bytes of points brought to the GPU so far; grows."""
        return self._points.store.loaded

    def release(self) -> None:
        """Give the GPU's memory back."""
        self._closing.release()
        drawing = (self._raster, self._splats, self._ground, self._picking, self._gbuffer)
        for part in (*drawing, self._points, self._passes):
            if part is not None:
                part.release()

    def _splat_params(
        self,
        camera: Camera,
        style: Style,
        samples: tuple[int, int],
        ranges: list[DrawRange],
        closing: float,
    ) -> SplatParams:
        """As large as closes the surface between as many points as are drawn."""
        stride = max((drawn.stride for drawn in ranges), default=1)
        natural, shape = splat_shape(self.clip)
        splats = SplatParams(
            camera=camera,
            samples=samples,
            radius=natural * style.point_size * closing * math.sqrt(stride),
            point_px_range=(MIN_POINT_PX * self.supersample, self._max_point_px),
            scene_radius=self._scene_radius,
            by_track=style.color_by in ("track", "age"),
            shape=shape,
            by_scalar=self._colors.scalar_field(style) is not ScalarField.NONE,
        )
        if style.pixels is not None:
            smallest = max(style.pixels * samples[1] / 720, splats.point_px_range[0])
            fixed = (smallest, self._max_point_px)
            smallest_radius = 1e-6 * splats.radius
            return replace(splats, radius=smallest_radius, point_px_range=fixed, shape=FACING)
        missing, drawn = _missing(ranges), sum(drawn.count for drawn in ranges)
        if missing:
            # Blocks of neighbours are missing. This passes soon: no larger than is drawn fast.
            gaps = math.sqrt(BLOCK * (drawn + missing) / max(drawn, 1))
            fast = MAX_RADIUS_PX / splats.px_per_unit(camera.eye_distance)
            radius = max(splats.radius, min(gaps * splats.radius, fast))
            return replace(splats, radius=radius)
        return splats

    def _ranges(
        self, layers: list[Layer], stride: int, upload_budget: float | None
    ) -> list[DrawRange]:
        wanted = [DrawRange(layer, layer.group.count, stride) for layer in layers]
        if upload_budget is None:
            return wanted
        resident = self._points.store.load(wanted, upload_budget)
        return [replace(drawn, count=n) for drawn, n in zip(wanted, resident, strict=True)]

    def _gbuffer_of(self, samples: tuple[int, int]) -> GBuffer:
        if self._gbuffer is None or self._gbuffer.size != samples:
            if self._gbuffer is not None:
                self._gbuffer.release()
                self._gbuffer = None
            with pictures_of(samples):
                self._gbuffer = GBuffer(self.context, samples)
        return self._gbuffer

    def _point_area(self, day: float, closing: float) -> float:
        """What one point covers: the more points share a scan's surface, the less."""
        index, _ = locate(self.clip, day)
        points = np.interp(day, self.clip.times, [scan.points for scan in self.clip.scans])
        count = max(len(self.clip.intervals[index]), 1)
        return float(4.0 * closing**2 * points / count)


def splat_shape(clip: Clip) -> tuple[float, SplatShape]:
    """The radius of a clip's splats, in closing distances, and what they make of a surface."""
    aligned = all(interval.normals is not None for interval in clip.intervals)
    return (ALIGNED_RADIUS, ALIGNED) if aligned else (NATURAL_RADIUS, FACING)


def scene_radius(clip: Clip) -> float:
    """Half the diagonal of the box around all that a clip shows, in its unit."""
    points = outline(clip)
    return max(float(np.linalg.norm(points.max(axis=0) - points.min(axis=0))) / 2, 1e-9)


def _missing(ranges: list[DrawRange]) -> int:
    """Points that are to be drawn, and are not on the GPU yet."""
    return sum(drawn.total - drawn.count for drawn in ranges)
