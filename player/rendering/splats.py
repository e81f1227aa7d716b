"""Draws splats that are larger than a sample, with soft edges."""

import math
from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np

from player.gl.framebuffer import NOTHING, GBuffer, draw_into, textures_of
from player.rendering.point_buffers import DrawRange
from player.rendering.point_cloud import PointCloud
from player.view.camera import Camera

MAX_MARGIN = 512  # largest distance in samples from a splat's centre to the picture


@dataclass(frozen=True)
class SplatParams:
    """How points are drawn as splats.

    samples:        width and height of the picture in samples.
    radius:         radius of a splat in the clip's unit.
    point_px_range: smallest and largest diameter of a splat in samples.
    scene_radius:   half the diagonal of the scene in the clip's unit.
    edge:           distance in radii to the mean of the surrounding splats' centres at which the
                    surface ends. Smaller values follow the sampled outline more closely, larger
                    ones are smoother; with 2 the surface ends only where its splats do.
    """

    camera: Camera
    samples: tuple[int, int]
    radius: float
    point_px_range: tuple[float, float]
    scene_radius: float
    edge: float

    @property
    def projection(self) -> Any:
        return self.camera.projection(self.samples[0] / self.samples[1])

    @property
    def focal_px(self) -> float:
        """Samples per unit of length at unit depth."""
        return 0.5 * self.samples[1] * float(self.projection[1, 1])

    def px_per_unit(self, view_depth: float) -> float:
        """Samples per unit of length at a depth."""
        return self.focal_px / (1.0 if self.camera.orthographic else view_depth)

    @property
    def typical_radius_px(self) -> float:
        """Radius of a splat in samples, at the depth of the camera's target."""
        radius_px = self.radius * self.px_per_unit(self.camera.eye_distance)
        return max(radius_px, self.point_px_range[0] / 2)

    def uniforms(self) -> dict[str, Any]:
        """The uniforms of the passes over points and of those over the picture."""
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
            "edge": self.edge,
            "lift": 0.0,
        }


def draw_splats(
    points: PointCloud, gbuffer: GBuffer, ranges: list[DrawRange], splats: SplatParams
) -> None:
    """Draw the nearest surface into the G-buffer, in two passes over the points.

    The first pass finds the depth of the nearest surface, the second one sums its splats. The
    surface that is computed from the sums ends inside the outermost splats.
    """
    picture, uniforms = (0, 0, *gbuffer.size), _with_margin(points, gbuffer, splats)
    draw_into(gbuffer.front, depth="<")
    gbuffer.front.clear(NOTHING, viewport=picture)
    points.draw("splat_depth", ranges, uniforms)
    draw_into(gbuffer.sums, depth="<", blend=(moderngl.ONE, moderngl.ONE))
    gbuffer.sums.clear(viewport=picture)
    points.draw("splat_sum", ranges, uniforms | {"lift": 1.0})
    summed = textures_of(gbuffer.sums)
    gbuffer.mark_tiles("splat_tiles", **summed)
    gbuffer.fill("splat_resolve", **uniforms, **summed)


def draw_behind(
    points: PointCloud, gbuffer: GBuffer, ranges: list[DrawRange], splats: SplatParams
) -> None:
    """Replace the G-buffer by the surface that shows behind the edges of the nearest one."""
    uniforms = _with_margin(points, gbuffer, splats)
    gbuffer.fill("splat_covered", **uniforms, **textures_of(gbuffer.lit))
    gbuffer.surface.viewport = gbuffer.front.viewport
    draw_into(gbuffer.surface, depth="<")
    points.draw("splat_behind", ranges, uniforms)


def _with_margin(points: PointCloud, gbuffer: GBuffer, splats: SplatParams) -> dict[str, Any]:
    """Set a viewport larger than the picture, and return the uniforms for it: OpenGL clips points
    by their centres, however large they are.
    """
    width, height = splats.samples
    widest = min(points.context.info["GL_MAX_VIEWPORT_DIMS"])
    reach = math.ceil(splats.radius * splats.px_per_unit(splats.camera.near))
    margin = max(min(reach, MAX_MARGIN, (widest - max(width, height)) // 2), 0)
    wide, tall = width + 2 * margin, height + 2 * margin
    gbuffer.front.viewport = gbuffer.sums.viewport = (-margin, -margin, wide, tall)
    shrunk = np.diag([width / wide, height / tall, 1.0, 1.0])
    front = textures_of(gbuffer.front)
    return splats.uniforms() | front | {"projection": shrunk @ splats.projection}
