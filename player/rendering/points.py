"""Draws small splats: points of one sample, with the holes between them filled afterwards.

One pass over the points finds the nearest point in every sample, either by a compute shader with
one atomic operation a point (OpenGL 4.3; after Schütz et al. 2021, "Rendering point clouds with
compute shaders and vertex order optimization") or by OpenGL's own points (3.3). Both give the same
result except where two points are equally near.
"""

from enum import StrEnum

import moderngl

from player.errors import PlayerError
from player.gl.framebuffer import GBuffer, texture
from player.gl.shader import Passes
from player.rendering.point_buffers import DrawRange
from player.rendering.point_cloud import PALETTE_UNIT, PointCloud
from player.rendering.splats import SplatParams

MAX_RADIUS_PX = 2.0  # largest radius in samples for which centres may be rounded to samples
MAX_TRACKS = 1024  # tracks that ten bits of a point's number distinguish


class RasterBackend(StrEnum):
    """How points are rasterised."""

    POINTS = "points"
    COMPUTE = "compute"


class PointTargets:
    """Number (nearest_point.glsl) and colour of the nearest point in every sample."""

    def __init__(self, context: moderngl.Context, size: tuple[int, int]) -> None:
        self.nearest, self.picked = (texture(context, size, 1, "u4") for _ in range(2))
        self._depth = context.depth_renderbuffer(size)
        self.framebuffer = context.framebuffer([self.nearest, self.picked], self._depth)

    def release(self) -> None:
        for part in (self.framebuffer, self.nearest, self.picked, self._depth):
            part.release()


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
        self._targets: PointTargets | None = None

    def draw(self, gbuffer: GBuffer, ranges: list[DrawRange], splats: SplatParams) -> None:
        """Draw the nearest surface into the G-buffer."""
        try:
            self.rasterise(ranges, splats)
        except PlayerError:  # the driver claims compute shaders, but fails to compile them
            if self.backend is RasterBackend.POINTS:
                raise
            self.backend = RasterBackend.POINTS
            self.rasterise(ranges, splats)
        self._fill_holes(gbuffer, splats)

    def rasterise(self, ranges: list[DrawRange], splats: SplatParams) -> None:
        """Find the nearest point in every sample: the only pass over all points."""
        context, targets = self._points.context, self._targets_for(splats.samples)
        uniforms = splats.uniforms()
        targets.framebuffer.use()
        context.enable_only(moderngl.DEPTH_TEST | moderngl.PROGRAM_POINT_SIZE)
        context.depth_func = "1"
        self._passes.fill("clear_points")
        context.depth_func = "<"
        if self.backend is RasterBackend.POINTS:
            self._points.draw("points", ranges, uniforms)
            return
        targets.nearest.bind_to_image(0, read=True, write=True)
        self._points.compute("points", ranges, uniforms, PICK=0)
        if not self._by_track(splats):
            targets.picked.bind_to_image(1, read=True, write=True)
            self._points.compute("points", ranges, uniforms, PICK=1)

    def _fill_holes(self, gbuffer: GBuffer, splats: SplatParams) -> None:
        targets = self._targets_for(splats.samples)
        targets.nearest.use(0)
        targets.picked.use(1)
        self._points.palette.use(PALETTE_UNIT)
        uniforms = splats.uniforms() | {"by_track": self._by_track(splats)}
        uniforms |= {"nearest": 0, "picked": 1, "palette": PALETTE_UNIT}
        reach = 1 if splats.typical_radius_px <= 1.5 else 2
        gbuffer.find_tiles(self._passes, "point_tiles", reach, **uniforms)
        gbuffer.fill_tiles(self._passes, "fill_holes", reach, **uniforms)

    def _by_track(self, splats: SplatParams) -> bool:
        """Whether the ten track bits of a point's number determine its colour."""
        clip = self._points.clip
        by_track = not splats.by_scalar and (splats.by_track or not clip.has_colors)
        return len(clip.track_table) <= MAX_TRACKS and by_track

    def _targets_for(self, size: tuple[int, int]) -> PointTargets:
        if self._targets is None or self._targets.nearest.size != size:
            self.release()
            self._targets = PointTargets(self._points.context, size)
        return self._targets

    def release(self) -> None:
        if self._targets is not None:
            self._targets.release()
