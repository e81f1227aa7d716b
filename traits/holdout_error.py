"""Distances between a clip and the scans that it was baked without (`bake --holdout`).

Section 4 of the paper, Figure 13. Distances are in the unit of the scans; the paper gives them
relative to the longest side of the bounding box of all scans.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gclip import Clip, Group, Interval, Motion
from gclip.evaluate import evaluate_layer, layers_at, locate


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
    """Compare a clip with each of the scans that it was baked without.

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
        spacing = float(np.median(KDTree(scan).query(scan, 2)[0][:, 1])) if len(scan) > 1 else 0.0
        identity = held.name, held.date, len(scan), spacing
        errors.append(HoldoutError(*identity, (first, second)))
        report_progress("verification", number, len(clip.held_out))
    return errors


def overall(errors: Sequence[HoldoutError]) -> tuple[Distances, Distances]:
    """Mean of the means, mean of the deviations and largest maximum, in both directions."""
    figures = np.array([error.distances for error in errors])  # (E, 2 directions, 3 statistics)
    statistics = np.where([True, True, False], figures.mean(axis=0), figures.max(axis=0))
    return Distances(*statistics[0].tolist()), Distances(*statistics[1].tolist())


def holdout_errors(clip: Clip) -> list[NDArray[np.float64]]:
    """Distances of movers from held-out scans.

    Returns
    -------
    list of (N,) float64 ndarray
        For each mover of each interval the distance to the nearest point of the scan that was held
        out in that interval, at the time of that scan. NaN if there is no such scan, or the mover
        is not part of the plant at that time.
    """
    from scipy.spatial import cKDTree

    errors = [np.full(len(interval), np.nan) for interval in clip.intervals]
    for scan in clip.held_out:
        index, nearest = locate(clip, scan.time)[0], cKDTree(scan.positions)
        for layer in layers_at(clip, scan.time):
            if layer.interval == index and not layer.litter and len(scan.positions):
                local, movers = evaluate_layer(clip, layer)[0], layer.group
                errors[index][movers.first : movers.stop] = nearest.query(local)[0]
    return errors


def held_out_as_clip(clip: Clip, index: int) -> tuple[Clip, NDArray[np.float64]]:
    """Make a clip of one interval without motion from a held-out scan.

    Parameters
    ----------
    clip : gclip.Clip
    index : int
        Of the scan in ``clip.held_out``.

    Returns
    -------
    clip : gclip.Clip
        Each point has the track and the colour of the nearest mover.
    distances : (N,) float64 ndarray
        From each point to that mover.
    """
    from scipy.spatial import cKDTree

    scan = clip.held_out[index]
    frame = clip.at(scan.time)
    distances, nearest = cKDTree(frame.local).query(scan.positions)
    colors = frame.colors[nearest] if clip.has_colors else None
    interval = Interval(
        start=clip.times[0],
        end=clip.times[-1],
        degree=1,
        groups=(Group(0, len(scan.positions), Motion.MOVE),),
        curve=(scan.positions, scan.positions),
        tracks=np.asarray(frame.tracks)[nearest].astype(np.uint32),
        start_colors=colors,
        end_colors=colors,
    )
    ends = tuple(replace(clip.scans[end], points=len(scan.positions)) for end in (0, -1))
    return replace(clip, scans=ends, intervals=(interval,), fields=(), held_out=()), distances
