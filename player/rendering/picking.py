"""Finds the organ at a position in the picture, by drawing track numbers on the GPU."""

import numpy as np

from player.gl.framebuffer import framebuffer, textures_of
from player.gl.shader import Passes
from player.rendering.point_buffers import DrawRange
from player.rendering.point_cloud import PointCloud
from player.rendering.points import clear_numbers
from player.rendering.splats import SplatParams

REACH = 10  # largest distance in pixels at which an organ still counts as hit
SIDE = 2 * REACH + 1
NO_TRACK = 0xFFFFFFFF


def track_at(
    points: PointCloud,
    passes: Passes,
    ranges: list[DrawRange],
    splats: SplatParams,
    at: tuple[float, float],
) -> int | None:
    """The track of the organ nearest to a position, of several the one in front; None if the
    position is beside the plant.

    at: the position in pixels from the top left corner of a picture of `splats.samples`.
    """
    width, height = splats.samples
    target = framebuffer(points.context, (SIDE, SIDE), (1, "u4"), deep=True)
    clear_numbers(passes, target)
    target.viewport = REACH - int(at[0]), REACH - (height - 1 - int(at[1])), width, height
    points.draw("splat_pick", ranges, splats.uniforms())
    (texture,) = textures_of(target)
    tracks = np.frombuffer(texture.read(), np.uint32).reshape(SIDE, SIDE)
    rows, columns = np.nonzero(tracks != NO_TRACK)
    distances = np.hypot(rows - REACH, columns - REACH)
    if not len(distances) or distances.min() > REACH:
        return None
    nearest = int(distances.argmin())
    return int(tracks[rows[nearest], columns[nearest]])
