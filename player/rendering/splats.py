"""Surface splatting: points drawn as overlapping discs that are larger than a sample."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any

import moderngl
import numpy as np
from numpy.typing import ArrayLike

from player.gl.framebuffer import TILE, GBuffer, draw_into, textures_of
from player.gl.shader import Rectangle
from player.rendering.point_buffers import DrawRange
from player.rendering.point_cloud import PointCloud
from player.view.camera import Camera
from shaders import NOTHING

MAX_MARGIN = 512  # samples by which the viewport extends beyond the picture at most


@dataclass(frozen=True)
class SplatParams:
    """Camera and size of splats for one picture."""

    camera: Camera
    samples: tuple[int, int]  #: width and height of the picture in samples
    radius: float  #: of a splat, in the clip's unit
    point_px_range: tuple[float, float]  #: smallest and largest diameter of a splat in samples
    scene_radius: float  #: half the diagonal of the scene in the clip's unit
    #: The surface ends where the mean of the surrounding centres is farther away than this, in
    #: radii. Small values follow the sampled outline, large ones smooth it; from 2 on only the
    #: splats themselves limit the surface.
    edge: float

    @cached_property
    def projection(self) -> Any:
        """(4, 4) projection matrix of the camera."""
        return self.camera.projection(self.samples[0] / self.samples[1])

    @property
    def focal_px(self) -> float:
        """Samples per unit of length at depth 1, or at any depth in a parallel projection."""
        return 0.5 * self.samples[1] * float(self.projection[1, 1])

    def px_per_unit(self, view_depth: float) -> float:
        """Samples per unit of length at a depth from the eye."""
        return self.focal_px / (1.0 if self.camera.orthographic else view_depth)

    def radius_px(self, before: float = 0.0) -> float:
        """Radius of a splat in samples, so many scene radii before the camera's target."""
        depth = max(self.camera.eye_distance - before * self.scene_radius, self.camera.near)
        return max(self.radius * self.px_per_unit(depth), self.point_px_range[0] / 2)

    def region(self, boxes: Iterable[ArrayLike]) -> Rectangle:
        """The part of the picture, in tiles, with splats whose centres are in (2, 3) boxes."""
        across, down = (-(-side // TILE) for side in self.samples)
        corners = [(*corner, 1.0) for box in boxes for corner in product(*np.transpose(box))]
        placed = np.array(corners) @ self.uniforms["to_samples"].T
        if placed[:, 2].min() < 0.0:  # the eye may be among the splats
            return 0, 0, across, down
        at, margin = placed[:, :2] / placed[:, 3:], self.radius_px(1.0) + 1.0
        edges = (at.min(axis=0) - margin) // TILE, (at.max(axis=0) + margin) // TILE + 1
        (left, bottom), (right, top) = np.clip(edges, 0, (across, down)).astype(int).tolist()
        return left, bottom, right - left, top - bottom

    @cached_property
    def uniforms(self) -> dict[str, Any]:
        """Uniforms that the passes over points and over the picture have in common."""
        camera, projection, view = self.camera, self.projection, self.camera.view()
        x, y, _, w = projection @ view
        share = (-view[2] - (0.0, 0.0, 0.0, camera.near)) / (camera.far - camera.near)
        width, height = self.samples
        return {
            "view": view,
            "projection": projection,
            "half_extent": (1.0 / float(projection[0, 0]), 1.0 / float(projection[1, 1])),
            "samples": self.samples,
            "to_samples": np.array([width / 2 * (x + w), height / 2 * (y + w), share, w]),
            "depth_range": (camera.near, camera.far),
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

    The first pass finds the depth of the nearest surface, the second one sums the splats on it with
    weights. Colours, normals and the surface's edge are computed from these sums.
    """
    picture, uniforms = (0, 0, *gbuffer.size), _with_margin(points, gbuffer, splats)
    draw_into(gbuffer.front, depth="<")
    gbuffer.front.clear(NOTHING, viewport=picture)
    points.draw("splat_depth", ranges, uniforms)
    draw_into(gbuffer.sums, depth="<", blend=(moderngl.ONE, moderngl.ONE))
    gbuffer.sums.clear(viewport=picture)
    points.draw("splat_sum", ranges, uniforms | {"lift": 1.0})
    summed = textures_of(gbuffer.sums)
    gbuffer.mark_tiles(summed["color_sums"])
    gbuffer.run("splat_resolve", gbuffer.surface, "1", **uniforms, **summed)


def _with_margin(points: PointCloud, gbuffer: GBuffer, splats: SplatParams) -> dict[str, Any]:
    """Set a viewport with a margin around the picture, and return the uniforms for it.

    OpenGL clips a point by its centre, so splats at the border would vanish as a whole.
    """
    width, height = splats.samples
    limit = (min(points.context.info["GL_MAX_VIEWPORT_DIMS"]) - max(width, height)) // 2
    radius_px = math.ceil(splats.radius * splats.px_per_unit(splats.camera.near))
    margin = max(min(radius_px, MAX_MARGIN, limit), 0)
    wide, tall = width + 2 * margin, height + 2 * margin
    gbuffer.front.viewport = gbuffer.sums.viewport = (-margin, -margin, wide, tall)
    scale = np.diag([width / wide, height / tall, 1.0, 1.0])
    front = textures_of(gbuffer.front)
    return splats.uniforms | front | {"projection": scale @ splats.projection}
