"""Drawing of small splats: points of one sample each, between which holes are filled afterwards.

One pass over the points finds the nearest point in each sample, either by a compute shader with one
atomic operation per point (OpenGL 4.3; after Schütz et al. 2021, "Rendering point clouds with
compute shaders and vertex order optimization") or by OpenGL's point primitives (3.3). The results
differ only where two points are equally near.
"""

import numpy as np

from player.errors import PlayerError
from player.gl.framebuffer import GBuffer, draw_into, textures_of
from player.rendering.point_buffers import DrawRange
from player.rendering.point_cloud import PointCloud
from player.rendering.splats import SplatParams
from shaders import CORE

MAX_RADIUS_PX = 2.0  # samples; for larger splats, rounding the centres to samples would show
SQUARED_DISTANCES = np.repeat([0, 1, 2, 4, 5], [1, 4, 4, 4, 8])  # of NEAREST in fill_holes.frag


class PointRaster:
    """Draws points of one sample, and fills the holes between them.

    compute: whether to use compute shaders, if the context supports them.
    """

    def __init__(self, points: PointCloud, compute: bool) -> None:
        self.compute = compute and points.context.version_code >= 430
        self._points = points

    def draw(self, gbuffer: GBuffer, ranges: list[DrawRange], splats: SplatParams) -> None:
        """Draw the nearest surface into the G-buffer."""
        try:
            self.rasterise(gbuffer, ranges, splats)
        except PlayerError:  # some drivers offer compute shaders, but fail to compile them
            if not self.compute:
                raise
            self.compute = False
            self.rasterise(gbuffer, ranges, splats)
        points = textures_of(gbuffer.points)
        radius = splats.radius_px(1.0) + 0.5  # of the nearest splat, as in fill_holes.frag
        reach = np.searchsorted(SQUARED_DISTANCES, 0.9 * radius**2)  # weights beyond are below 1 %
        gbuffer.mark_tiles(points["nearest"], int(SQUARED_DISTANCES[reach - 1] ** 0.5))
        uniforms = splats.uniforms | points | {"palette": self._points.palette}
        macros = {
            "REACH": reach,
            "CORE_REACH": np.searchsorted(SQUARED_DISTANCES, (CORE * radius) ** 2, "right"),
            "COLOR_FROM_TRACK": int(self._points.color_from_track),
        }
        gbuffer.run("fill_holes", gbuffer.surface, "1", **macros, **uniforms)

    def rasterise(self, gbuffer: GBuffer, ranges: list[DrawRange], splats: SplatParams) -> None:
        """Find the nearest point in each sample, by one pass over all points."""
        uniforms = splats.uniforms
        nearest, picked = textures_of(gbuffer.points).values()
        if not self.compute:
            draw_into(gbuffer.points, depth="<")
            gbuffer.points.clear(depth=1.0)  # leaves integers undefined
            nearest.write(gbuffer.ones)
            self._points.draw("points", ranges, uniforms)
            return
        nearest.write(gbuffer.ones)
        nearest.bind_to_image(0, read=True, write=True)
        self._points.compute("points", ranges, uniforms, PICK=0)
        if not self._points.color_from_track:
            picked.write(gbuffer.ones)
            picked.bind_to_image(1, read=True, write=True)
            self._points.compute("points", ranges, uniforms, PICK=1)
