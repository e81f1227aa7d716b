"""Rendering of a clip at one time into a framebuffer.

A picture is drawn in steps: the plant's shadow on the floor (ground.py); colour and depth of the
nearest surface, from points of one sample (points.py) or from splats (splats.py); filtering of the
depths and lighting (shading.py); and composition over the background (picture.frag).
"""

import math
from dataclasses import replace

import moderngl
import numpy as np

from gclip import Clip
from gclip.evaluate import layers_at
from gclip.schema import BLOCK
from player.gl.framebuffer import TILE, GBuffer, draw_into, framebuffer, textures_of
from player.gl.shader import Passes
from player.gl.timers import PassTimers
from player.rendering.ground import Ground
from player.rendering.point_buffers import DrawRange, full_ranges
from player.rendering.point_cloud import PointCloud
from player.rendering.points import MAX_RADIUS_PX, PointRaster
from player.rendering.shading import shade, smooth_depths
from player.rendering.splat_radius import ClosingDistances
from player.rendering.splats import SplatParams, draw_splats
from player.view.camera import Camera, sampled_positions
from player.view.style import Style

# Radius of splats in closing distances: neighbours drift apart between scans, and edges need more
# overlap than holes do.
SPLAT_RADIUS = 2.4
# Edges (SplatParams) of discs that face the camera, and of those along the surface.
FACING_EDGE, ALIGNED_EDGE = 2.0, 0.47
MIN_POINT_PX = 1.5  # smallest diameter of a splat in pixels
PICK_RADIUS = 10  # largest distance in pixels between a click and the organ that it picks


class Renderer:
    """Draws one clip in one context.

    supersample: samples along each side of a pixel where splats have no soft outlines of their own.
    compute:     whether compute shaders draw small splats, if the context supports them.
    memory:      bytes of GPU memory for points; by default a share of what the driver reports.
    timers:      measures the passes, optional.
    """

    def __init__(
        self,
        context: moderngl.Context,
        clip: Clip,
        supersample: int = 1,
        *,
        compute: bool = True,
        memory: int | None = None,
        timers: PassTimers | None = None,
    ) -> None:
        self.context = context
        self.clip = clip
        self.supersample = supersample
        self._points = PointCloud(context, clip, memory, timers)
        self._passes = Passes(context, timers, TILE=TILE)
        self._raster = PointRaster(self._points, compute)
        self._ground = Ground(self._points, self._passes)
        self._closing = ClosingDistances(clip)
        self._gbuffer: GBuffer | None = None
        self._max_point_px = float(context.info["GL_POINT_SIZE_RANGE"][1])
        self._scene_radius = scene_radius(clip)

    def draw(
        self,
        target: moderngl.Framebuffer,
        day: float,
        camera: Camera,
        style: Style,
        size: tuple[int, int],
        *,
        stride: int = 1,
        upload_budget: float | None = None,
        transparent: bool = False,
    ) -> bool:
        """Draw the plant on a day, and leave the framebuffer bound.

        day:           in the clip's unit of time.
        size:          (width, height) of the framebuffer in pixels.
        stride:        draw every n-th point only, with larger splats.
        upload_budget: seconds for uploading points, unlimited by default. Points that are not on
                       the GPU by then are not drawn.
        transparent:   draw no background; alpha is unassociated.

        Returns whether all points were drawn.
        """
        self.context.gc()
        ranges, splats = self._prepare(day, camera, style, size, stride, upload_budget)
        side = self.supersample if splats.radius_px() <= MAX_RADIUS_PX else 1
        diameters = (side * MIN_POINT_PX, self._max_point_px)
        splats = replace(splats, samples=(side * size[0], side * size[1]), point_px_range=diameters)
        gbuffer, points = self._gbuffer_of(splats.samples), self._points
        gbuffer.region = splats.region(self.clip.intervals[r.layer.interval].bounds for r in ranges)
        gbuffer.clear()
        are_points = splats.radius_px() <= MAX_RADIUS_PX
        if are_points:
            self._raster.draw(gbuffer, ranges, splats)
        else:
            draw_splats(points, gbuffer, ranges, splats)
        if are_points or splats.edge == FACING_EDGE:
            smooth_depths(gbuffer, splats)
        shade(gbuffer, splats, style)
        if style.floor and not transparent:
            self._ground.cast_shadow(ranges, self._closing.point_area(day))
        background = self._ground.draw(splats, style)
        target.viewport = (0, 0, *size)
        draw_into(target)
        if transparent:
            target.clear()
        else:
            self._passes.run("blit", picture=background["background"])
        uniforms = textures_of(gbuffer.lit) | background | {"transparent": transparent}
        self._passes.run("picture", gbuffer.tiles(TILE // side), SUPERSAMPLE=side, **uniforms)
        target.viewport = (0, 0, *size)
        if upload_budget is not None:
            self._closing.measure_ahead()
        return stride == 1 and not any(drawn.missing for drawn in ranges)

    def organ_at(
        self,
        day: float,
        camera: Camera,
        style: Style,
        position: tuple[float, float],
        size: tuple[float, float],
    ) -> int | None:
        """The organ nearest to a position in the picture, and of several organs the foremost one.

        Points that are not on the GPU yet, and organs that lie on the ground, are ignored.

        position: right and down from the top left corner of the picture.
        size:     width and height of the picture in the same unit.

        Returns the organ's track, or None if there is no organ within PICK_RADIUS pixels.
        """
        width, height = (max(round(side), 1) for side in size)
        ranges, splats = self._prepare(day, camera, style, (width, height), 1, 0.0)
        standing = [drawn for drawn in ranges if not drawn.layer.litter]
        side = 2 * PICK_RADIUS + 1
        target = framebuffer(self.context, (side, side), tracks=(1, "u4"), with_depth=True)
        draw_into(target, depth="<")
        target.clear(depth=1.0)
        pixels = textures_of(target)["tracks"]
        pixels.write(b"\xff" * (4 * side * side))
        x, y = int(position[0]), height - 1 - int(position[1])
        target.viewport = PICK_RADIUS - x, PICK_RADIUS - y, width, height
        self._points.draw("splat_pick", standing, splats.uniforms)
        tracks = np.frombuffer(pixels.read(), np.uint32).reshape(side, side)
        rows, columns = np.nonzero(~tracks)  # all bits are set where no point is
        distances = np.hypot(rows - PICK_RADIUS, columns - PICK_RADIUS)
        if distances.min(initial=np.inf) > PICK_RADIUS:
            return None
        nearest = int(distances.argmin())
        return int(tracks[rows[nearest], columns[nearest]])

    @property
    def loaded(self) -> int:
        """Number of slices of points uploaded so far."""
        return self._points.buffers.loaded

    def release(self) -> None:
        """Stop the thread that measures closing distances."""
        self._closing.stop()

    def _prepare(
        self,
        day: float,
        camera: Camera,
        style: Style,
        size: tuple[int, int],
        stride: int,
        upload_budget: float | None,
    ) -> tuple[list[DrawRange], SplatParams]:
        """Set colours, upload points, and return what to draw; parameters: see `draw`."""
        self._points.set_colors(day, style)
        ranges = full_ranges(layers_at(self.clip, day), stride)
        if upload_budget is not None:
            ranges = self._points.buffers.load(ranges, upload_budget)
        radius = SPLAT_RADIUS * style.point_size * self._closing.at(day) * math.sqrt(stride)
        diameters = (MIN_POINT_PX, self._max_point_px)
        edge = splat_edge(self.clip)
        splats = SplatParams(camera, size, radius, diameters, self._scene_radius, edge)
        missing = sum(drawn.missing for drawn in ranges)
        if missing:
            # Points are missing in blocks of neighbours. Larger splats fill these gaps, up to the
            # radius for which the faster of the two drawing methods can be used.
            count = max(sum(drawn.count for drawn in ranges), 1)
            fast_radius = MAX_RADIUS_PX / splats.px_per_unit(camera.eye_distance)
            filling_radius = math.sqrt(BLOCK * (count + missing) / count) * radius
            splats = replace(splats, radius=max(radius, min(filling_radius, fast_radius)))
        return ranges, splats

    def _gbuffer_of(self, samples: tuple[int, int]) -> GBuffer:
        if self._gbuffer is None or self._gbuffer.size != samples:
            self._gbuffer = None
            self.context.gc()
            self._gbuffer = GBuffer(self.context, self._passes, samples)
        return self._gbuffer


def splat_edge(clip: Clip) -> float:
    """The edge of a clip's splats (SplatParams)."""
    has_normals = all(interval.normals is not None for interval in clip.intervals)
    return ALIGNED_EDGE if has_normals else FACING_EDGE


def scene_radius(clip: Clip) -> float:
    """Half the diagonal of a clip's bounding box over all times, in the clip's unit."""
    points = sampled_positions(clip)
    return max(float(np.linalg.norm(points.max(axis=0) - points.min(axis=0))) / 2, 1e-9)
