"""Draws small splats: points of one sample, with the holes between them filled afterwards.

One pass over the points finds the nearest point in every sample, either by a compute shader with
one atomic operation a point (OpenGL 4.3; after Schütz et al. 2021, "Rendering point clouds with
compute shaders and vertex order optimization") or by OpenGL's own points (3.3). Both give the same
result except where two points are equally near.
"""

from enum import StrEnum

import moderngl

from player.errors import PlayerError
from player.gl.framebuffer import GBuffer, textures_of
from player.gl.shader import Passes
from player.rendering.point_buffers import DrawRange
from player.rendering.point_cloud import PointCloud
from player.rendering.splats import SplatParams

MAX_RADIUS_PX = 2.0  # largest radius in samples for which centres may be rounded to samples
MAX_TRACKS = 1024  # tracks that ten bits of a point's number distinguish


class RasterBackend(StrEnum):
    """How points are rasterised."""

    POINTS = "points"
    COMPUTE = "compute"


class PointRaster:
    """Draws points and fills the holes between them.

    backend: compute shaders by default, where the context has them.
    """

    def __init__(
        self, points: PointCloud, passes: Passes, backend: RasterBackend | None = None
    ) -> None:
        has_compute = points.context.version_code >= 430
        wanted = backend or RasterBackend.COMPUTE
        self.backend = wanted if has_compute else RasterBackend.POINTS
        self._points = points
        self._passes = passes

    def draw(self, gbuffer: GBuffer, ranges: list[DrawRange], splats: SplatParams) -> None:
        """Draw the nearest surface into the G-buffer."""
        try:
            self.rasterise(gbuffer, ranges, splats)
        except PlayerError:  # the driver claims compute shaders, but fails to compile them
            if self.backend is RasterBackend.POINTS:
                raise
            self.backend = RasterBackend.POINTS
            self.rasterise(gbuffer, ranges, splats)
        nearest, picked = textures_of(gbuffer.points)
        reach = 1 if splats.typical_radius_px <= 1.5 else 2
        gbuffer.mark_tiles(self._passes, "point_tiles", reach=reach, nearest=nearest)
        uniforms = splats.uniforms() | {
            "nearest": nearest,
            "picked": picked,
            "palette": self._points.palette,
            "by_track": self._by_track(splats),
        }
        gbuffer.fill(self._passes, "fill_holes", reach=reach, **uniforms)

    def rasterise(self, gbuffer: GBuffer, ranges: list[DrawRange], splats: SplatParams) -> None:
        """Find the nearest point in every sample: the only pass over all points."""
        context, uniforms = self._points.context, splats.uniforms()
        gbuffer.points.use()
        context.enable_only(moderngl.DEPTH_TEST | moderngl.PROGRAM_POINT_SIZE)
        context.depth_func = "1"
        self._passes.fill("clear_points")
        context.depth_func = "<"
        if self.backend is RasterBackend.POINTS:
            self._points.draw("points", ranges, uniforms)
            return
        nearest, picked = textures_of(gbuffer.points)
        nearest.bind_to_image(0, read=True, write=True)
        self._points.compute("points", ranges, uniforms, PICK=0)
        if not self._by_track(splats):
            picked.bind_to_image(1, read=True, write=True)
            self._points.compute("points", ranges, uniforms, PICK=1)

    def _by_track(self, splats: SplatParams) -> bool:
        """Whether the ten track bits of a point's number determine its colour."""
        clip = self._points.clip
        by_track = not splats.by_scalar and (splats.by_track or not clip.has_colors)
        return len(clip.track_table) <= MAX_TRACKS and by_track
