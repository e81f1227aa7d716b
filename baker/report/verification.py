"""Verification by leaving scans out (paper section 4 and its Figure 13).

At the time of each scan left out the clip is compared with it, both ways, in the scans' own unit.
The paper gives such distances as shares of the longest side of the box around all scans.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import point_spacing
from baker.pipeline import Survey
from gclip import Clip


class Distances(NamedTuple):
    """From each point of one cloud to the nearest of another."""

    mean: float
    deviation: float
    maximum: float

    @classmethod
    def of(cls, nearest: NDArray[np.float64]) -> Self:
        return cls(float(nearest.mean()), float(nearest.std()), float(nearest.max()))


@dataclass(frozen=True)
class HoldoutError:
    """The distance of the clip from a scan that it was baked without; lengths in the clip's unit.

    Errors below about half of the `spacing` only say that both are samples of a surface.
    """

    name: str
    date: str
    time: float
    points: int  #: of the scan
    spacing: float  #: median distance between neighbouring points of the scan
    reconstruction_to_scan: Distances  #: small where nothing was made up
    scan_to_reconstruction: Distances  #: small where nothing is missing

    @property
    def both(self) -> tuple[Distances, Distances]:
        """Reconstruction to scan, then scan to reconstruction."""
        return self.reconstruction_to_scan, self.scan_to_reconstruction


def verify(
    clip: Clip,
    record: Survey,
    report_progress: Callable[[str, int, int], None] = lambda stage, done, total: None,
) -> list[HoldoutError]:
    """Compare a clip with the scans that were held out of it.

    Parameters
    ----------
    clip : gclip.Clip
    record : Survey
        Of its bake.
    report_progress : callable, optional
        Called with "verification", the scans compared and the scans in all.

    Returns
    -------
    list of HoldoutError
        One for each scan that was held out.

    References
    ----------
    Section 4 of the paper, Figure 13.
    """
    from scipy.spatial import KDTree

    errors = []
    for number, held in enumerate(record.held_out, 1):
        points, film = held.positions, clip.at(held.time).local
        sizes = len(points), point_spacing(points)
        pairs = ((points, film), (film, points))
        both = [Distances.of(KDTree(to).query(found)[0]) for to, found in pairs]
        errors.append(HoldoutError(held.name, held.date, held.time, *sizes, *both))
        report_progress("verification", number, len(record.held_out))
    return errors


def overall(errors: Sequence[HoldoutError]) -> tuple[Distances, Distances]:
    """Mean of the means, mean of the deviations and largest of the maxima, both ways."""
    each = np.array([error.both for error in errors])  # (errors, 2 directions, 3 figures)
    every = np.concatenate([each[..., :2].mean(axis=0), each[..., 2:].max(axis=0)], axis=1)
    to_scan, to_reconstruction = every.tolist()
    return Distances(*to_scan), Distances(*to_reconstruction)


def error_lines(errors: Sequence[HoldoutError], unit: str) -> list[str]:
    """A table of the errors, two rows a scan left out, and of all together."""
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
