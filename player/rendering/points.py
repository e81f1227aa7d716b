"""Drawing of small splats: points of one sample each, between which holes are filled afterwards.

One pass over the points finds the nearest point in each sample, either by a compute shader with one
atomic operation per point (OpenGL 4.3; after Schütz et al. 2021, "Rendering point clouds with
compute shaders and vertex order optimization") or by OpenGL's point primitives (3.3). The results
differ only where two points are equally near.
"""

from enum import StrEnum

import moderngl

from player.errors import PlayerError
from player.gl.framebuffer import GBuffer, draw_into, textures_of
from player.gl.shader import Passes
from player.rendering.point_buffers import DrawRange
from player.rendering.point_cloud import PointCloud
from player.rendering.splats import SplatParams

MAX_RADIUS_PX = 2.0  # samples; for larger splats, rounding the centres to samples would show


class RasterBackend(StrEnum):
    """How points are rasterised."""

    POINTS = "points"
    COMPUTE = "compute"


class PointRaster:
    """Draws points of one sample, and fills the holes between them.

    backend: by default compute shaders, if the context supports them.
    """

    def __init__(self, points: PointCloud, backend: RasterBackend | None = None) -> None:
        has_compute = points.context.version_code >= 430
        preferred = backend or RasterBackend.COMPUTE
        self.backend = preferred if has_compute else RasterBackend.POINTS
        self._points = points

    def draw(self, gbuffer: GBuffer, ranges: list[DrawRange], splats: SplatParams) -> None:
        """Draw the nearest surface into the G-buffer."""
        try:
            self.rasterise(gbuffer, ranges, splats)
        except PlayerError:  # some drivers offer compute shaders, but fail to compile them
            if self.backend is RasterBackend.POINTS:
                raise
            self.backend = RasterBackend.POINTS
            self.rasterise(gbuffer, ranges, splats)
        radius_px = 1 if splats.typical_radius_px <= 1.5 else 2
        points = textures_of(gbuffer.points)
        gbuffer.mark_tiles(points["nearest"], radius_px)
        uniforms = splats.uniforms | points | {"palette": self._points.palette}
        macros = {"RADIUS_PX": radius_px, "COLOR_FROM_TRACK": int(self._points.color_from_track)}
        gbuffer.run("fill_holes", gbuffer.surface, "1", **macros, **uniforms)

    def rasterise(self, gbuffer: GBuffer, ranges: list[DrawRange], splats: SplatParams) -> None:
        """Find the nearest point in each sample, by one pass over all points."""
        uniforms = splats.uniforms
        by_points = self.backend is RasterBackend.POINTS
        clear_integers(gbuffer.passes, gbuffer.points, depth="<" if by_points else "")
        if by_points:
            self._points.draw("points", ranges, uniforms)
            return
        nearest, picked = textures_of(gbuffer.points).values()
        nearest.bind_to_image(0, read=True, write=True)
        self._points.compute("points", ranges, uniforms, PICK=0)
        if not self._points.color_from_track:
            picked.bind_to_image(1, read=True, write=True)
            self._points.compute("points", ranges, uniforms, PICK=1)


def clear_integers(passes: Passes, target: moderngl.Framebuffer, depth: str = "<") -> None:
    """Clear a framebuffer of unsigned integers and bind it for drawing with a depth function."""
    draw_into(target, depth=depth and "1")
    passes.run("clear_points")
    draw_into(target, depth=depth)
