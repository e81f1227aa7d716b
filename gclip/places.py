"""Which organ of a clip a correction means: places in the files of its scans."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

import msgspec
import numpy as np
from numpy.typing import NDArray

from gclip.corrections import Correction, Place
from gclip.errors import UserError

if TYPE_CHECKING:
    from gclip.clip import Clip

Point = NDArray[np.float64]


def with_names(clip: Clip, corrections: Sequence[Correction]) -> Clip:
    """A clip whose organs have the names that they were given since it was baked.

    Parameters
    ----------
    clip : Clip
        As it was baked.
    corrections : sequence of gclip.corrections.Correction
        Other ones than names are for the next bake; names of scans that the clip lacks, too.

    Returns
    -------
    Clip

    Raises
    ------
    UserError
        Where two organs would have the same name.
    """
    baked = baked_corrections(clip)
    named = [one for one in corrections if one.kind == "name" and one not in baked]
    names = {_track_at(clip, one.places[0]): one.name for one in named}
    table = tuple(replace(t, name=names.get(t.id, t.name)) for t in clip.track_table)
    for track in table:
        if track.id in names and [one.name for one in table].count(track.name) > 1:
            raise UserError(f"Two organs are called '{track.name}'; rename one of them.")
    return replace(clip, track_table=table)


def baked_corrections(clip: Clip) -> tuple[Correction, ...]:
    """Those that a clip was baked with; none where it does not say so."""
    with suppress(KeyError, TypeError, msgspec.ValidationError):  # a clip may say anything
        found = clip.provenance["options"]["corrections"]
        return msgspec.convert(found, tuple[Correction, ...])
    return ()


def in_file(clip: Clip, scan: str, point: Point) -> Point:
    """A point of the clip, about its origin, in the coordinates of a scan's own file."""
    transform, origin, scale = _file_frame(clip, scan)
    return np.asarray((np.linalg.solve(transform, [*point, 1.0])[:3] + origin) / scale)


def _track_at(clip: Clip, place: Place) -> int | None:
    """Id of the organ whose point is nearest to a place; None where the clip lacks its scan."""
    scan = next((scan for scan in clip.scans if scan.name == place.scan), None)
    if scan is None:
        return None
    transform, origin, scale = _file_frame(clip, place.scan)
    point = (transform @ [*(scale * np.array(place.point) - origin), 1.0])[:3]
    frame = clip.at(scan.time)
    # Organs that are born later wait on their parents, at the very places of points of these.
    born = np.array([track.born for track in clip.track_table])[frame.tracks] <= scan.time
    distance = np.where(born, np.linalg.norm(frame.local - point, axis=1), np.inf)
    return int(frame.tracks[distance.argmin()]) if len(frame) else None


def _file_frame(clip: Clip, scan: str) -> tuple[NDArray[np.float64], Point, float]:
    """How a scan's file becomes the clip's points: scaled, taken about an origin, and moved by a
    (4, 4) matrix.
    """
    made = clip.provenance
    with suppress(KeyError, TypeError, ValueError, IndexError, OverflowError):
        index = [one["name"] for one in made["inputs"]].index(scan)
        transform = np.array(made["transforms"][index], float)
        origin = np.array(made["origins"][index] if "origins" in made else clip.origin, float)
        scale = float(made["options"]["scale"])
        sound = np.isfinite([*transform.ravel(), *origin, scale]).all() and scale > 0.0
        if sound and transform.shape == (4, 4) and abs(np.linalg.det(transform)) > 1e-12:
            return transform, origin, scale
    return np.eye(4), np.array(clip.origin), 1.0  # a clip made by hand, or by a stranger
