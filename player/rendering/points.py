"""Draws small splats: points of one sample, with the holes between them filled afterwards.

One pass over the points finds the nearest point in every sample, either by a compute shader with
one atomic operation a point (OpenGL 4.3; after Schütz et al. 2021, "Rendering point clouds with
compute shaders and vertex order optimization") or by OpenGL's own points (3.3). Both give the same
result except where two points are equally near.
"""

from enum import StrEnum

import moderngl

from player.errors import PlayerError
from player.gl.framebuffer import GBuffer, draw_into, textures_of
from player.gl.shader import Passes
from player.rendering.point_buffers import DrawRange
from player.rendering.point_cloud import PointCloud
from player.rendering.splats import SplatParams

MAX_RADIUS_PX = 2.0  # largest radius in samples for which centres may be rounded to samples


class RasterBackend(StrEnum):
    """How points are rasterised."""

    POINTS = "points"
    COMPUTE = "compute"


class PointRaster:
    """Draws points and fills the holes between them.

    backend: compute shaders by default, where the context has them.
    """

    def __init__(self, points: PointCloud, backend: RasterBackend | None = None) -> None:
        has_compute = points.context.version_code >= 430
        wanted = backend or RasterBackend.COMPUTE
        self.backend = wanted if has_compute else RasterBackend.POINTS
        self._points = points

    def draw(self, gbuffer: GBuffer, ranges: list[DrawRange], splats: SplatParams) -> None:
        """Draw the nearest surface into the G-buffer."""
        try:
            self.rasterise(gbuffer, ranges, splats)
        except PlayerError:  # the driver claims compute shaders, but fails to compile them
            if self.backend is RasterBackend.POINTS:
                raise
            self.backend = RasterBackend.POINTS
            self.rasterise(gbuffer, ranges, splats)
        reach, found = 1 if splats.typical_radius_px <= 1.5 else 2, textures_of(gbuffer.points)
        gbuffer.mark_tiles("point_tiles", reach=reach, **found)
        colors = {"palette": self._points.palette, "by_track": self._points.tracks_tell_colors}
        gbuffer.fill("fill_holes", reach=reach, **splats.uniforms(), **found, **colors)

    def rasterise(self, gbuffer: GBuffer, ranges: list[DrawRange], splats: SplatParams) -> None:
        """Find the nearest point in every sample: the only pass over all points."""
        uniforms = splats.uniforms()
        clear_numbers(gbuffer.passes, gbuffer.points)
        if self.backend is RasterBackend.POINTS:
            self._points.draw("points", ranges, uniforms)
            return
        nearest, picked = textures_of(gbuffer.points).values()
        nearest.bind_to_image(0, read=True, write=True)
        self._points.compute("points", ranges, uniforms, PICK=0)
        if not self._points.tracks_tell_colors:
            picked.bind_to_image(1, read=True, write=True)
            self._points.compute("points", ranges, uniforms, PICK=1)


def clear_numbers(passes: Passes, target: moderngl.Framebuffer) -> None:
    """Clear a framebuffer of integers, the first to its largest value, and draw into it next."""
    draw_into(target, depth="1")
    passes.fill("clear_points")
    draw_into(target, depth="<")
