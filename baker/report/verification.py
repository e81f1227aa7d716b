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
    distances: tuple[Distances, Distances]
    """Reconstruction to scan, large where the clip has points that the scan lacks; and scan to
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
        identity = held.name, held.date, len(scan), point_spacing(scan)
        errors.append(HoldoutError(*identity, (first, second)))
        report_progress("verification", number, len(clip.held_out))
    return errors


def overall(errors: Sequence[HoldoutError]) -> tuple[Distances, Distances]:
    """Mean of the means, mean of the deviations and largest maximum, in both directions."""
    figures = np.array([error.distances for error in errors])  # (E, 2 directions, 3 statistics)
    statistics = np.where([True, True, False], figures.mean(axis=0), figures.max(axis=0))
    return Distances(*statistics[0].tolist()), Distances(*statistics[1].tolist())


def error_lines(errors: Sequence[HoldoutError], unit: str) -> list[str]:
    """Format the errors as a table, with a row for each scan and one for all together."""
    rows = [(f"{error.date}, {error.name}", error.distances) for error in errors]
    rows += [("all", overall(errors))] if len(errors) > 1 else []
    title = f"left out{unit and f' ({unit})'}"
    width = max(len(title), *(len(name) for name, _ in rows))
    return [
        f"{'':<{width}}{'reconstruction to scan':>30}{'scan to reconstruction':>30}",
        f"{title:<{width}}" + f"{'mean':>10}{'std':>10}{'max':>10}" * 2,
        *(f"{n:<{width}}" + "".join(f"{v:>10.3g}" for v in (*a, *b)) for n, (a, b) in rows),
    ]
