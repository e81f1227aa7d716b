"""Points of one sample each, closed to a surface afterwards: for many points and small splats.

One pass over the points finds the nearest in every sample, by a compute shader with one atomic
operation a point (OpenGL 4.3; after Schütz et al. 2021, "Rendering point clouds with compute
shaders and vertex order optimization") or by OpenGL's own points (3.3). Both leave the same ones,
but where two are equally near.
"""

from enum import StrEnum

import moderngl

from player.errors import PlayerError
from player.gl.framebuffer import GBuffer, texture
from player.gl.shader import Passes
from player.rendering.point_buffers import DrawRange
from player.rendering.point_cloud import PALETTE_UNIT, PointCloud
from player.rendering.splats import SplatParams

MAX_RADIUS_PX = 2.0  # of splats in samples, up to which a centre may be rounded to a sample
MAX_TRACKS = 1024  # that a point's ten bits tell apart


class RasterBackend(StrEnum):
    """What puts the points into the picture."""

    POINTS = "points"
    COMPUTE = "compute"


class PointTargets:
    """The nearest point's number in every sample (nearest_point.glsl), and its colour."""

    def __init__(self, context: moderngl.Context, size: tuple[int, int]) -> None:
        self.nearest, self.picked = (texture(context, size, 1, "u4") for _ in range(2))
        self._depth = context.depth_renderbuffer(size)
        self.framebuffer = context.framebuffer([self.nearest, self.picked], self._depth)

    def release(self) -> None:
        for part in (self.framebuffer, self.nearest, self.picked, self._depth):
            part.release()


class PointRaster:
    """Draws points and closes the surface between them.

    backend: None takes compute shaders where the context has them.
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
        """Leave the nearest surface in the G-buffer."""
        try:
            self.rasterise(ranges, splats)
        except PlayerError:  # a driver that promises compute shaders and can't compile ours
            if self.backend is RasterBackend.POINTS:
                raise
            self.backend = RasterBackend.POINTS
            self.rasterise(ranges, splats)
        self._fill_holes(gbuffer, splats)

    def rasterise(self, ranges: list[DrawRange], splats: SplatParams) -> None:
        """Find the nearest point in every sample: the one pass over all of them."""
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
        """Whether the ten bits in a point's number name its colour."""
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
