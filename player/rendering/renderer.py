"""Draws a clip on a day into a framebuffer.

A picture is made in steps: colour and depth of the nearest surface, from points of one sample
(points.py) or from splats (splats.py); filtered depths; the plant's shadow on the floor; lighting
(shading.py); and the composition over the background.
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
from player.rendering.ground import Ground
from player.rendering.point_buffers import DrawRange, whole
from player.rendering.point_cloud import PointCloud
from player.rendering.points import MAX_RADIUS_PX, PointRaster, RasterBackend, clear_numbers
from player.rendering.shading import shade, smooth_depths
from player.rendering.splat_radius import ClosingDistances
from player.rendering.splats import SplatParams, draw_behind, draw_splats
from player.view.camera import Camera, outline
from player.view.style import Style

# Radius of a splat in closing distances, above 1 because neighbours drift apart between scans, and
# its edge (SplatParams): of discs that face the camera, and of discs along the surface, by its
# normals. It takes more overlap to find the surface's edge than to close its holes.
FACING, ALIGNED = (2.3, 2.0), (2.6, 0.38)
MIN_POINT_PX = 1.5  # smallest diameter of a splat in pixels
PICK_REACH = 10  # largest distance in pixels at which an organ still counts as hit
NO_TRACK = 0xFFFFFFFF  # of pixels without a point (clear_points.frag)


class Renderer:
    """Draws one clip in one context.

    supersample: samples along each side of a pixel; 1 in a window, 2 for export.
    backend:     draws small splats; compute shaders by default, where there are any.
    memory:      bytes of GPU memory for points; by default the driver is asked.
    gpu_seconds: GPU time of the picture before the last one, which has been completed by then.
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
        self.gpu_seconds = 0.0
        self._points = PointCloud(context, clip, memory)
        self.timers = self._points.timers
        self._passes = Passes(context, self.timers, SUPERSAMPLE=supersample, TILE=TILE)
        self._raster = PointRaster(self._points, backend)
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
        """Draw the plant on a day over all of a framebuffer.

        Returns whether every point was drawn. The framebuffer stays bound, without a depth test.

        size:          width and height of the framebuffer in pixels.
        stride:        draw every n-th point only, and larger.
        upload_budget: seconds for uploading points, as long as needed by default. Points that are
                       not on the GPU by then are left out.
        transparent:   draw the plant without a background, with unassociated alpha.
        """
        self.context.gc()
        self.gpu_seconds = self.timers.finish_frame()
        samples = (size[0] * self.supersample, size[1] * self.supersample)
        gbuffer, points = self._gbuffer_of(samples), self._points
        ranges, splats = self._prepared(day, camera, style, samples, stride, upload_budget)
        if style.show_ground and not transparent:
            self._ground.cast_shadow(ranges, self._closing.point_area(day))
        gbuffer.clear()
        are_points = splats.typical_radius_px <= MAX_RADIUS_PX
        if are_points:
            self._raster.draw(gbuffer, ranges, splats)
        else:
            draw_splats(points, gbuffer, ranges, splats)
        smooth_depths(gbuffer, splats)
        shade(gbuffer, splats, style)
        if not are_points and splats.edge < 1.0:
            draw_behind(points, gbuffer, ranges, splats)
            shade(gbuffer, splats, style)
        target.viewport = (0, 0, *size)
        draw_into(target)
        uniforms = splats.uniforms() | self._ground.uniforms(camera, style)
        light = textures_of(gbuffer.lit)
        self._passes.fill("picture", **uniforms, **light, transparent=transparent)
        if upload_budget is not None:
            self._closing.measure_ahead()
        return stride == 1 and not any(drawn.missing for drawn in ranges)

    def organ_at(
        self,
        day: float,
        camera: Camera,
        style: Style,
        at: tuple[float, float],
        size: tuple[float, float],
    ) -> int | None:
        """The track of the organ nearest to a position in the picture, of several the one in front;
        None beside the plant. The GPU draws the numbers of the tracks around the position.

        Points that are not on the GPU yet and organs that lie on the ground are ignored.

        at:   the position, from the top left corner.
        size: width and height of the picture, in the same unit.
        """
        width, height = (max(round(side), 1) for side in size)
        ranges, splats = self._prepared(day, camera, style, (width, height), 1, 0.0)
        standing = [drawn for drawn in ranges if not drawn.layer.litter]
        side = 2 * PICK_REACH + 1
        target = framebuffer(self.context, (side, side), tracks=(1, "u4"), deep=True)
        clear_numbers(self._passes, target)
        x, y = int(at[0]), height - 1 - int(at[1])
        target.viewport = PICK_REACH - x, PICK_REACH - y, width, height
        self._points.draw("splat_pick", standing, splats.uniforms())
        pixels = textures_of(target)["tracks"].read()
        tracks = np.frombuffer(pixels, np.uint32).reshape(side, side)
        rows, columns = np.nonzero(tracks != NO_TRACK)
        distances = np.hypot(rows - PICK_REACH, columns - PICK_REACH)
        if distances.min(initial=np.inf) > PICK_REACH:
            return None
        nearest = int(distances.argmin())
        return int(tracks[rows[nearest], columns[nearest]])

    @property
    def loaded(self) -> int:
        """Number of slices of points uploaded so far."""
        return self._points.buffers.loaded

    def release(self) -> None:
        """Stop the thread that measures the clip."""
        self._closing.stop()

    def _prepared(
        self,
        day: float,
        camera: Camera,
        style: Style,
        samples: tuple[int, int],
        stride: int,
        upload_budget: float | None,
    ) -> tuple[list[DrawRange], SplatParams]:
        """Set colours, and upload points: which of them to draw, and the splats that close the
        surface between these.
        """
        self._points.set_colors(day, style)
        ranges = whole(layers_at(self.clip, day), stride)
        if upload_budget is not None:
            ranges = self._points.buffers.load(ranges, upload_budget)
        natural, edge = splat_shape(self.clip)
        radius = natural * style.point_size * self._closing.at(day) * math.sqrt(stride)
        sizes = (MIN_POINT_PX * self.supersample, self._max_point_px)
        splats = SplatParams(camera, samples, radius, sizes, self._scene_radius, edge)
        missing = sum(drawn.missing for drawn in ranges)
        if missing:
            # Whole blocks of neighbours are missing until they are uploaded; larger splats fill
            # the gaps, as long as they are drawn fast.
            drawn = max(sum(one.count for one in ranges), 1)
            fast = MAX_RADIUS_PX / splats.px_per_unit(camera.eye_distance)
            filling = math.sqrt(BLOCK * (drawn + missing) / drawn) * radius
            splats = replace(splats, radius=max(radius, min(filling, fast)))
        return ranges, splats

    def _gbuffer_of(self, samples: tuple[int, int]) -> GBuffer:
        if self._gbuffer is None or self._gbuffer.size != samples:
            self._gbuffer = None
            self.context.gc()
            self._gbuffer = GBuffer(self.context, self._passes, samples)
        return self._gbuffer


def splat_shape(clip: Clip) -> tuple[float, float]:
    """The radius of a clip's splats in closing distances, and their edge."""
    aligned = all(interval.normals is not None for interval in clip.intervals)
    return ALIGNED if aligned else FACING


def scene_radius(clip: Clip) -> float:
    """Half the diagonal of a clip's bounding box, in its unit."""
    points = outline(clip)
    return max(float(np.linalg.norm(points.max(axis=0) - points.min(axis=0))) / 2, 1e-9)
