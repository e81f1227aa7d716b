"""Points as soft round splats, wherever they lie between the samples: for splats of some size."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from player.gl.framebuffer import texture
from player.view.camera import Camera

if TYPE_CHECKING:
    import moderngl

    from player.gl.framebuffer import GBuffer
    from player.gl.shader import Passes
    from player.rendering.point_buffers import DrawRange
    from player.rendering.point_cloud import PointCloud

MAX_MARGIN = 512  # samples: how far outside of the picture the centres of splats may lie
NO_CHANNELS, ALL_CHANNELS = [(False,) * 4] * 2, [(True,) * 4] * 2


@dataclass(frozen=True)
class SplatParams:
    """How points are seen: as round splats, of a size in the world, that face the eye.

    samples:        (width, height) of the picture.
    radius:         of a splat, in the clip's unit.
    point_px_range: least and greatest diameter in samples.
    scene_radius:   in the clip's unit.
    by_track:       coloured by track, else by the scans' colours where there are any.
    by_scalar:      coloured by a scalar field instead.
    """

    camera: Camera
    samples: tuple[int, int]
    radius: float
    point_px_range: tuple[float, float]
    scene_radius: float
    by_track: bool
    by_scalar: bool = False

    @property
    def projection(self) -> Any:
        return self.camera.projection(self.samples[0] / self.samples[1])

    @property
    def focal_px(self) -> float:
        """Samples that one unit takes up where the projection divides by 1."""
        return 0.5 * self.samples[1] * float(self.projection[1, 1])

    def px_per_unit(self, view_depth: float) -> float:
        """Samples that one unit takes up at a depth before the eye."""
        return self.focal_px / (1.0 if self.camera.orthographic else view_depth)

    @property
    def typical_radius_px(self) -> float:
        """In samples, at the camera's target."""
        radius_px = self.radius * self.px_per_unit(self.camera.eye_distance)
        return max(radius_px, self.point_px_range[0] / 2)

    def uniforms(self) -> dict[str, Any]:
        """For all passes over the points and over the picture."""
        projection = self.projection
        focal = (float(projection[0, 0]), float(projection[1, 1]))
        return {
            "view": self.camera.view(),
            "projection": projection,
            "focal": focal,
            "half_extent": (1.0 / focal[0], 1.0 / focal[1]),
            "samples": self.samples,
            "depth_range": (self.camera.near, self.camera.far),
            "target_depth": self.camera.eye_distance,
            "scene_radius": self.scene_radius,
            "perspective": 0.0 if self.camera.orthographic else 1.0,
            "radius": self.radius,
            "focal_px": self.focal_px,
            "point_px_range": self.point_px_range,
            "by_track": self.by_track,
        }


class Splats:
    """Two passes over the points: the nearest surface's depth, then the sum of the splats on it."""

    def __init__(self, points: PointCloud, passes: Passes) -> None:
        self._points = points
        self._passes = passes
        self._max_viewport = min(points.context.info["GL_MAX_VIEWPORT_DIMS"])
        self._sums: SplatSums | None = None

    def draw(self, gbuffer: GBuffer, ranges: list[DrawRange], splats: SplatParams) -> None:
        """Leave the nearest surface in the G-buffer."""
        import moderngl

        context, sums = self._points.context, self._sums_for(splats.samples)
        framebuffer = sums.framebuffer
        framebuffer.depth_mask = True
        framebuffer.use()
        framebuffer.clear()
        context.enable_only(moderngl.PROGRAM_POINT_SIZE | moderngl.DEPTH_TEST)
        context.depth_func = "<"
        # OpenGL drops a point whose centre lies outside of the viewport, however far it reaches.
        width, height = splats.samples
        reach = math.ceil(splats.radius * splats.px_per_unit(splats.camera.near))
        margin = max(min(reach, MAX_MARGIN, (self._max_viewport - max(width, height)) // 2), 0)
        wide, tall = width + 2 * margin, height + 2 * margin
        shrunk = np.diag([width / wide, height / tall, 1.0, 1.0])
        uniforms = splats.uniforms() | {"projection": shrunk @ splats.projection}
        framebuffer.viewport = (-margin, -margin, wide, tall)
        framebuffer.color_mask = NO_CHANNELS  # type: ignore[assignment]
        self._points.draw("splat_depth", ranges, uniforms)

        framebuffer.color_mask = ALL_CHANNELS  # type: ignore[assignment]
        framebuffer.depth_mask = False
        context.enable(moderngl.BLEND)
        context.blend_func = moderngl.ONE, moderngl.ONE
        self._points.draw("splat_sum", ranges, uniforms)
        framebuffer.viewport = (0, 0, width, height)

        sums.colors.use(0)
        sums.depths.use(1)
        reach = max(int(splats.point_px_range[0] / 1.5), 1)
        gbuffer.fill(
            *(self._passes, "splat_tiles", "splat_resolve", reach),
            **uniforms,
            color_sums=0,
            depth_sums=1,
        )

    def _sums_for(self, size: tuple[int, int]) -> SplatSums:
        if self._sums is None or self._sums.colors.size != size:
            self.release()
            self._sums = SplatSums(self._points.context, size)
        return self._sums

    def release(self) -> None:
        if self._sums is not None:
            self._sums.release()


class SplatSums:
    """The nearest surface's depth, and the splats summed upon it, of each sample."""

    def __init__(self, context: moderngl.Context, size: tuple[int, int]) -> None:
        self.colors = texture(context, size, 4, "f2")
        self.depths = texture(context, size, 1, "f2")
        self._depth = context.depth_renderbuffer(size)
        self.framebuffer = context.framebuffer([self.colors, self.depths], self._depth)

    def release(self) -> None:
        for part in (self.framebuffer, self.colors, self.depths, self._depth):
            part.release()
