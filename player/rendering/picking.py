"""Finds the organ at a position in the picture, by drawing track numbers on the GPU."""

import moderngl
import numpy as np

from player.gl.framebuffer import target
from player.gl.shader import Passes
from player.rendering.point_buffers import DrawRange
from player.rendering.point_cloud import PointCloud
from player.rendering.splats import SplatParams

REACH = 10  # largest distance in pixels at which an organ still counts as hit
SIDE = 2 * REACH + 1
NO_TRACK = 0xFFFFFFFF


class Picking:
    """Draws the tracks in a small window around a position."""

    def __init__(self, points: PointCloud, passes: Passes) -> None:
        self._points = points
        self._passes = passes
        self._framebuffer, (self._tracks,) = target(
            points.context, (SIDE, SIDE), (1, "u4"), deep=True
        )

    def track_at(
        self, ranges: list[DrawRange], splats: SplatParams, at: tuple[float, float]
    ) -> int | None:
        """The track of the organ nearest to a position, of several the one in front; None if the
        position is beside the plant.

        at: the position in pixels from the top left corner of a picture of `splats.samples`.
        """
        context, (width, height) = self._points.context, splats.samples
        self._framebuffer.viewport = (0, 0, SIDE, SIDE)
        self._framebuffer.use()
        context.enable_only(moderngl.DEPTH_TEST | moderngl.PROGRAM_POINT_SIZE)
        context.depth_func = "1"
        self._passes.fill("clear_points")
        context.depth_func = "<"
        left, bottom = REACH - int(at[0]), REACH - (height - 1 - int(at[1]))
        self._framebuffer.viewport = (left, bottom, width, height)
        self._points.draw("splat_pick", ranges, splats.uniforms())
        context.enable_only(moderngl.NOTHING)
        tracks = np.frombuffer(self._tracks.read(), np.uint32).reshape(SIDE, SIDE)
        rows, columns = np.nonzero(tracks != NO_TRACK)
        distances = np.hypot(rows - REACH, columns - REACH)
        if not len(distances) or distances.min() > REACH:
            return None
        nearest = int(distances.argmin())
        return int(tracks[rows[nearest], columns[nearest]])
