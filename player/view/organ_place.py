"""Positions on organs by which corrections identify them."""

import numpy as np
from numpy.typing import NDArray

from corrections import Place
from corrections.provenance import file_to_local
from gclip import Clip
from player.view.camera import Camera

# Points that are less than this share of the picture's height farther from the click than the
# nearest one compete; the foremost of them was clicked.
CLICK_TOLERANCE = 0.02


def organ_place(
    clip: Clip,
    track: int,
    day: float,
    click: tuple[Camera, float, tuple[float, float]] | None = None,
) -> Place | None:
    """A point of an organ in the coordinates of a scan's file; None if no scan beside a day has it.

    track: index of the organ in ``clip.track_table``.
    day:   selects the scan nearest in time, or the next nearest one if the organ is not in it.
    click: camera, width of the picture divided by its height, and the position clicked: right and
           up from the centre, from -1 to 1. By default the organ's most central point is chosen.
    """
    for scan in sorted(clip.scans, key=lambda scan: abs(scan.time - day))[:2]:
        frame = clip.at(scan.time)
        points = frame.local[frame.tracks == track].astype(np.float64)
        if len(points):
            central = np.linalg.norm(points - points.mean(axis=0), axis=1).argmin()
            point = points[_clicked_index(points, *click) if click else central]
            x, y, z, _ = np.linalg.solve(file_to_local(clip, scan.name), [*point, 1.0]).tolist()
            return Place(scan.name, (x, y, z), clip.track_table[track].name)
    return None


def _clicked_index(
    points: NDArray[np.float64], camera: Camera, aspect: float, position: tuple[float, float]
) -> int:
    matrix = camera.matrix(aspect)
    right, up, depth, w = matrix[:, :3] @ points.T + matrix[:, 3:]
    distance = np.hypot(aspect * (right / w - position[0]), up / w - position[1])
    candidates = np.flatnonzero(distance <= distance.min() + CLICK_TOLERANCE)
    return int(candidates[(depth / w)[candidates].argmin()])
