"""Where on an organ someone clicked."""

from collections.abc import Sequence
from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from corrections import Place
from gclip import Clip
from player.view.camera import Camera

UNDER_CURSOR = 0.02  # of the picture's height: what is nearest to the eye within it was clicked


def organ_place(
    clip: Clip,
    track: int,
    day: float,
    seen: tuple[Camera, float, tuple[float, float]] | None = None,
) -> Place | None:
    """A point of an organ in the scan nearest in time, or in the next one where that lacks it, in
    the file's own coordinates; None where neither has the organ.

    seen: how the organ is seen, the picture's width by its height, and where it was clicked: right
          and up from the middle, from -1 to 1. Without it a point in the organ's middle is chosen.
    """
    for scan in sorted(clip.scans, key=lambda scan: abs(scan.time - day))[:2]:
        frame = clip.at(scan.time)
        points = frame.local[frame.tracks == track].astype(np.float64)
        if len(points):
            middle = np.linalg.norm(points - points.mean(axis=0), axis=1).argmin()
            point = points[_clicked(points, *seen) if seen else middle]
            x, y, z, _ = np.linalg.solve(_to_local(clip, scan.name), [*point, 1.0]).tolist()
            return Place(scan.name, (x, y, z), clip.track_table[track].name)
    return None


def _clicked(
    points: NDArray[np.float64], camera: Camera, aspect: float, at: tuple[float, float]
) -> int:
    matrix = camera.matrix(aspect)
    right, up, depth, scale = matrix[:, :3] @ points.T + matrix[:, 3:]
    distance = np.hypot(aspect * (right / scale - at[0]), up / scale - at[1])
    near = np.flatnonzero(distance <= distance.min() + UNDER_CURSOR)
    return int(near[(depth / scale)[near].argmin()])


def _to_local(clip: Clip, scan: str) -> NDArray[np.float64]:
    """(4, 4) transform from the coordinates in a scan's file to the clip's local coordinates."""
    given = clip.provenance
    wrong = (LookupError, TypeError, ValueError, OverflowError)  # provenance may hold anything
    with suppress(*wrong), np.errstate(all="ignore"):
        index = [entry["name"] for entry in given["inputs"]].index(scan)
        origin = given["origins"][index] if "origins" in given else clip.origin
        transform = np.array(given["transforms"][index], float).reshape(4, 4) @ _shift(origin)
        transform[:, :3] *= float(given["options"]["scale"])
        if np.isfinite(transform).all() and np.isfinite(np.linalg.inv(transform)).all():
            return transform
    return _shift(clip.origin)  # the clip was made by another program


def _shift(origin: Sequence[float]) -> NDArray[np.float64]:
    """(4, 4) transform to coordinates relative to an origin."""
    shift = np.eye(4)
    shift[:3, 3] -= origin
    return shift
