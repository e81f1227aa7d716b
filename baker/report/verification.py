"""Verify a clip against scans that were left out of it (section 4 of the paper, Figure 13).

Distances are in the unit of the scans. The paper gives them relative to the longest side of the
bounding box of all scans.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from baker.geometry.neighbors import point_spacing
from gclip import Clip


class Distances(NamedTuple):
    """Statistics of the distances from the points of one cloud to the nearest of another."""

    mean: float
    deviation: float
    maximum: float


@dataclass(frozen=True)
class HoldoutError:
    """The distances between a clip and a scan that was left out of it, in the clip's unit.

    Two samples of the same surface have mean distances of about half the `spacing`.
    """

    name: str
    date: str
    points: int  #: number of points of the scan
    spacing: float  #: median distance between neighbouring points of the scan
    both: tuple[Distances, Distances]
    """Reconstruction to scan, large where the clip has points that the scan has not; and scan to
    reconstruction, large where the clip lacks points of the scan."""


def verify(
    clip: Clip,
    report_progress: Callable[[str, int, int], None] = lambda stage, done, total: None,
) -> list[HoldoutError]:
    """Compare a clip with each of the scans that were left out of it (section 4 of the paper).

    Parameters
    ----------
    clip : Clip
    report_progress : callable
        Called with "verification", the number of scans compared and their total.
    """
    from scipy.spatial import KDTree

    errors = []
    for number, held in enumerate(clip.held_out, 1):
        scan, reconstruction = held.positions, clip.at(held.time).local
        pairs = ((scan, reconstruction), (reconstruction, scan))
        nearest = [KDTree(target).query(source)[0] for target, source in pairs]
        first, second = (Distances(*map(float, (d.mean(), d.std(), d.max()))) for d in nearest)
        named = held.name, held.date, len(scan), point_spacing(scan)
        errors.append(HoldoutError(*named, (first, second)))
        report_progress("verification", number, len(clip.held_out))
    return errors


def overall(errors: Sequence[HoldoutError]) -> tuple[Distances, Distances]:
    """Mean of the means, mean of the deviations and largest maximum, in both directions."""
    figures = np.array([error.both for error in errors])  # (errors, 2 directions, 3 statistics)
    merged = np.concatenate([figures[..., :2].mean(axis=0), figures[..., 2:].max(axis=0)], axis=1)
    to_scan, to_reconstruction = merged.tolist()
    return Distances(*to_scan), Distances(*to_reconstruction)


def error_lines(errors: Sequence[HoldoutError], unit: str) -> list[str]:
    """Format the errors as a table, with two rows for each scan and for all together."""
    rows = [("left out", f"distance{unit and f', {unit}'}", "mean", "std", "max")]
    named = [(f"{error.date}, {error.name}", error.both) for error in errors]
    for name, both in named + ([("all", overall(errors))] if len(errors) > 1 else []):
        directions = zip(("reconstruction to scan", "scan to reconstruction"), both, strict=True)
        for label, (direction, distances) in zip((name, ""), directions, strict=True):
            mean, deviation, maximum = (f"{distance:.3g}" for distance in distances)
            rows.append((label, direction, mean, deviation, maximum))
    width = max(len(row[0]) for row in rows)
    return [
        f"{name:<{width}}  {direction:<27}" + "".join(f"{figure:>10}" for figure in figures)
        for name, direction, *figures in rows
    ]
