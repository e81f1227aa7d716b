"""Find the organs of a clip that corrections mean, by positions in the files of its scans."""

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


def rename_organs(clip: Clip, corrections: Sequence[Correction]) -> Clip:
    """Apply the corrections of names that were made after the clip was baked.

    Parameters
    ----------
    clip : Clip
        As it was baked.
    corrections : sequence of gclip.corrections.Correction
        Those of other kinds, and names in scans that the clip does not have, are ignored.

    Returns
    -------
    Clip

    Raises
    ------
    UserError
        If two organs would have the same name.
    """
    baked = baked_corrections(clip)
    new = [each for each in corrections if each.kind == "name" and each not in baked]
    names = {_track_at(clip, each.places[0]): each.name for each in new}
    table = tuple(replace(t, name=names.get(t.id, t.name)) for t in clip.track_table)
    for track in table:
        if track.id in names and [other.name for other in table].count(track.name) > 1:
            raise UserError(f"Two organs are called '{track.name}'; rename one of them.")
    return replace(clip, track_table=table)


def baked_corrections(clip: Clip) -> tuple[Correction, ...]:
    """The corrections that a clip was baked with, as its provenance lists them."""
    with suppress(KeyError, TypeError, msgspec.ValidationError):  # provenance may hold anything
        listed = clip.provenance["options"]["corrections"]
        return msgspec.convert(listed, tuple[Correction, ...])
    return ()


def to_file_coordinates(clip: Clip, scan: str, point: Point) -> Point:
    """Convert a point from the clip's local coordinates to those of a scan's file.

    Parameters
    ----------
    clip : Clip
    scan : str
        Name of the scan.
    point : Point
    """
    return np.asarray(np.linalg.solve(_to_local(clip, scan), [*point, 1.0])[:3])


def _track_at(clip: Clip, place: Place) -> int | None:
    """The id of the organ nearest to a place; None where the clip does not have its scan."""
    scan = next((scan for scan in clip.scans if scan.name == place.scan), None)
    if scan is None:
        return None
    point = (_to_local(clip, scan.name) @ [*place.point, 1.0])[:3]
    frame = clip.at(scan.time)
    # Organs that are born later start at points of their parents, so they are left out.
    born = np.array([track.born for track in clip.track_table])[frame.tracks] <= scan.time
    distance = np.where(born, np.linalg.norm(frame.local - point, axis=1), np.inf)
    return int(frame.tracks[distance.argmin()]) if len(frame) else None


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
