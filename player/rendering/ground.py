"""The background: a wall, a floor, and the plant's soft shadow on the floor."""

from dataclasses import replace
from functools import partial
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from gclip import Clip
from player.gl.framebuffer import draw_into, framebuffer, textures_of
from player.gl.shader import Passes
from player.rendering.point_buffers import DrawRange
from player.rendering.point_cloud import PointCloud
from player.view.camera import Camera, axes, outline
from player.view.style import GROUNDS, Style

SIDE = 128  # texels along each side of the floor
CONTACT_REACH = 0.12  # height over which contact shadows fade, as a share of half the floor's side
SHADOW_POINTS = 10_000  # points that the shadow is computed from
MAX_CANDIDATES = 1 << 20  # points of each range that these are sampled from


class Ground:
    """The floor under a clip's plant, and the plant's shadow."""

    def __init__(self, points: PointCloud, passes: Passes) -> None:
        self._points = points
        self._passes = passes
        # First the summed coverage, then shares of the light, for which bytes are precise enough.
        create = partial(framebuffer, points.context, (SIDE, SIDE), linear=True)
        kinds = ((2, "f2"), (4, "f1"), (4, "f1"))
        self._shadows = [create(shadow=kind) for kind in kinds]
        self._to_square, self._half_side = floor_square(points.clip)

    def cast_shadow(self, ranges: list[DrawRange], point_area: float) -> None:
        """Render the shadow; point_area: area in the clip's unit that each of all points covers."""
        draw_into(self._shadows[0], blend=(moderngl.ONE, moderngl.ONE))
        self._shadows[0].clear()
        candidates = sum(min(-(-one.count // one.stride), MAX_CANDIDATES) for one in ranges)
        share = min(SHADOW_POINTS / max(candidates, 1), 1.0)
        texel = (2.0 * self._half_side / SIDE) ** 2
        for drawn in ranges:
            count, stride = min(drawn.count, MAX_CANDIDATES), max(round(drawn.stride / share), 1)
            each = drawn.layer.group.count / max(-(-count // stride), 1)
            uniforms = {
                "from_above": self._to_square,
                "reach": CONTACT_REACH * self._half_side,
                "cover": each * point_area / texel,
            }
            self._points.draw("shadow", [replace(drawn, count=count, stride=stride)], uniforms)
        for i, step in enumerate(((1.0 / SIDE, 0.0), (0.0, 1.0 / SIDE))):
            draw_into(self._shadows[i + 1])
            source = textures_of(self._shadows[i])["shadow"]
            self._passes.fill("blur", source=source, direction=step, saturate=i == 0)

    def uniforms(self, camera: Camera, style: Style) -> dict[str, Any]:
        """The uniforms of ground.glsl."""
        return {
            "to_floor": self._to_square @ np.linalg.inv(camera.view()),
            "floor_share": float(style.show_ground),
            **vars(GROUNDS[style.ground]),
            **textures_of(self._shadows[-1]),
        }


def floor_square(clip: Clip) -> tuple[NDArray[np.float64], float]:
    """The square on the floor that the plant's shadow may fall on, and half its side.

    The square is a (4, 4) matrix from local coordinates to [-1, 1] × [-1, 1] on the floor and the
    height above it; half its side is in the clip's unit.
    """
    points = outline(clip)
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2
    spread = float(np.hypot(*(points[:, :2] - middle[:2]).T).max())
    half_side = 1.7 * max(spread, 0.5 * float(high[2] - low[2]), 1e-9)
    matrix = np.eye(4)
    matrix[:3, :3] = axes(clip.up)
    matrix[:3, 3] = -middle[0], -middle[1], -clip.floor
    matrix[:2] /= half_side
    return matrix, half_side
