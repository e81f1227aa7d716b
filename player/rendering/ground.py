"""The background: a wall, a floor, and the plant's shadow on the floor."""

from dataclasses import replace
from functools import partial
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from gclip import Clip
from player.gl.framebuffer import VECTOR, draw_into, framebuffer, textures_of
from player.gl.shader import Passes
from player.rendering.point_buffers import DrawRange
from player.rendering.point_cloud import PointCloud
from player.rendering.splats import SplatParams
from player.view.camera import sampled_positions
from player.view.style import GROUNDS, Style
from traits.upright import upright_axes

SHADOW_SIZE = 96  # texels along each side of the shadow texture
CONTACT_HEIGHT = 0.12  # over which contact shadows fade by 1/e, as a share of half the floor's side
SHADOW_POINTS = 2_500  # points that the shadow is computed from
MAX_CANDIDATES = 1 << 20  # points of each range from which these are sampled
BACKGROUND_SIZE = 256, 144  # texels of the background, which has no edges, for pictures of any size


class Ground:
    """Draws the background, and the shadow of a clip's plant on the floor."""

    def __init__(self, points: PointCloud, passes: Passes) -> None:
        self._points = points
        self._passes = passes
        create = partial(framebuffer, points.context, linear=True)
        self._shadows = [create((SHADOW_SIZE,) * 2, transmittance=VECTOR) for _ in range(2)]
        self._background = create(BACKGROUND_SIZE, background=(4, "f4"))
        self._to_square, self._half_side = floor_square(points.clip)

    def cast_shadow(self, ranges: list[DrawRange], point_area: float) -> None:
        """Render the shadow of some points.

        point_area: area of the surface divided by the number of all points, in squared units.
        """
        draw_into(self._shadows[0], blend=(moderngl.ZERO, moderngl.ONE_MINUS_SRC_COLOR))
        self._shadows[0].clear(1.0, 1.0)
        candidates = sum(min(-(-r.count // r.stride), MAX_CANDIDATES) for r in ranges)
        share = min(SHADOW_POINTS / max(candidates, 1), 1.0)
        texel_area = (2.0 * self._half_side / SHADOW_SIZE) ** 2
        for drawn in ranges:
            count, stride = min(drawn.count, MAX_CANDIDATES), max(round(drawn.stride / share), 1)
            represented = drawn.layer.group.count / max(-(-count // stride), 1)  # points per sample
            uniforms = {
                "from_above": self._to_square,
                "contact_height": CONTACT_HEIGHT * self._half_side,
                "cover": represented * point_area / texel_area,
            }
            self._points.draw("shadow", [replace(drawn, count=count, stride=stride)], uniforms)
        for i, step in enumerate(((1.0 / SHADOW_SIZE, 0.0), (0.0, 1.0 / SHADOW_SIZE))):
            draw_into(self._shadows[1 - i])
            self._passes.run("blur", **textures_of(self._shadows[i]), direction=step)

    def draw(self, splats: SplatParams, style: Style) -> dict[str, Any]:
        """Draw the background, and return its texture by the name of its uniform."""
        draw_into(self._background)
        self._passes.run(
            "ground",
            to_floor=self._to_square @ np.linalg.inv(splats.uniforms["view"]),
            **splats.uniforms,
            **vars(GROUNDS[style.ground]),
            **style.uniforms,
            **textures_of(self._shadows[0]),
        )
        return textures_of(self._background)


def floor_square(clip: Clip) -> tuple[NDArray[np.float64], float]:
    """The square of the floor that may receive the plant's shadow, and half its side.

    The square is a (4, 4) matrix for column vectors, from local coordinates to x and y in [-1, 1]
    on the square and the height above it. Lengths are in the clip's unit.
    """
    points = sampled_positions(clip)
    low, high = points.min(axis=0), points.max(axis=0)
    center = (low + high) / 2
    radius = float(np.hypot(*(points[:, :2] - center[:2]).T).max())
    half_side = 1.7 * max(radius, 0.5 * float(high[2] - low[2]), 1e-9)
    matrix = np.eye(4)
    matrix[:3, :3] = upright_axes(clip.up)
    matrix[:3, 3] = -center[0], -center[1], -clip.floor
    matrix[:2] /= half_side
    return matrix, half_side
