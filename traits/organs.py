"""Sample the points of the organs of a clip at a time, as evenly as those of the scans."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gclip.evaluate import layers_at, locate, newborn, positions_on_curve

if TYPE_CHECKING:
    from gclip import Clip

Points = NDArray[np.float64]

MAX_POINTS = 2500  # number of points of an organ that are measured, a random sample
CLOUD_FACTOR = 8  # number of points to which the surface is fitted : number that are measured
DENSITY_NEIGHBORS = 8  # the distance to this neighbour estimates the local density


class Organ(NamedTuple):
    """The points of an organ at a time, relative to the clip's origin.

    Attributes
    ----------
    points : ndarray of shape (N, 3)
        Points to measure.
    cloud : ndarray of shape (M, 3)
        A larger sample that includes these points.
    mixed : float
        0 if all points come from one scan, 1 if half of them come from each of two.
    in_previous_scan : bool
        Whether the previous scan has the organ; otherwise its size is a guess.
    noise_weight : float
        Weight of the organ in the estimate of the noise: it rises from 0 to 1 in the interval
        before the organ's first scan.
    """

    points: Points
    cloud: Points
    mixed: float = 0.0
    in_previous_scan: bool = True
    noise_weight: float = 1.0


class Sample(NamedTuple):
    """Organs by track id, and the weight of their measurements, in (0, 1]."""

    weight: float
    organs: dict[int, Organ]


def samples_at(clip: Clip, day: float) -> list[Sample]:
    """Sample the organs of a clip at a time.

    Several movers may share a start or an end point. One sample has one mover for each start point,
    the other one for each end point. At the time of a scan, the sample is the scan; in between,
    both samples are measured and weighted by time, so that traits are continuous. The start points
    of an organ that is born are those of the organ that it grows from, so both samples of its own
    use its end points.

    Parameters
    ----------
    clip : gclip.Clip
    day : float
        Time, in the clip's unit.

    Returns
    -------
    list of Sample
        One or two samples, whose weights sum to 1.
    """
    index, passed = locate(clip, day)
    begin = clip.intervals[index].start
    born = np.array([track.born for track in clip.track_table])
    lost = [track.lost for track in clip.track_table]
    owner = np.arange(len(born))
    for track, ancestor in newborn(clip, index).items():
        owner[track] = ancestor
    weights = (1.0 - passed, passed)
    moved: set[int] = set()
    parts: tuple[dict[int, list[Points]], dict[int, list[Points]]] = ({}, {})
    for layer in layers_at(clip, day):
        if layer.litter:
            continue
        interval = clip.intervals[layer.interval]
        movers = slice(layer.group.first, layer.group.stop)
        positions = positions_on_curve(interval, movers, layer.parameter).astype(np.float64)
        tracks = np.asarray(interval.tracks[movers])
        starts, ends = (np.asarray(interval.curve[end][movers]) for end in (0, -1))
        is_born = born[tracks] > begin
        own = np.flatnonzero(is_born)
        moved |= {track for track in np.unique(tracks[~is_born]).tolist() if lost[track] != begin}
        # Where a new organ shares start points with the one that it grows from, that comes first.
        order = np.argsort(is_born, kind="stable")
        sides = [(0, order, owner[tracks], starts), (1, order, tracks, ends)]
        if passed:
            sides.append((0, own, tracks, ends))
        for k, chosen, organs, points in sides:
            if weights[k]:
                for track, indices in _distinct(organs[chosen], points[chosen]).items():
                    parts[k].setdefault(track, []).append(positions[chosen[indices]])
    mixed = 4.0 * passed * (1.0 - passed)
    return [
        Sample(
            weight,
            {
                track: Organ(
                    *_even_sample(np.concatenate(points), weight),
                    mixed=mixed if track in moved else 0.0,
                    in_previous_scan=bool(born[track] <= begin) or passed == 1.0,
                    noise_weight=passed if born[track] == begin else float(born[track] < begin),
                )
                for track, points in part.items()
            },
        )
        for part, weight in zip(parts, weights, strict=True)
        if weight
    ]


def _distinct(tracks: NDArray[np.integer], points: NDArray) -> dict[int, NDArray[np.intp]]:
    """Indices of the first mover at each distinct one of (N, 3) points, by track."""
    order = np.lexsort((*points.T[::-1], tracks))
    sorted_tracks, sorted_points = tracks[order], points[order]
    first = np.ones(len(order), bool)
    first[1:] = sorted_tracks[1:] != sorted_tracks[:-1]
    first[1:] |= (sorted_points[1:] != sorted_points[:-1]).any(axis=1)
    order, sorted_tracks = order[first], sorted_tracks[first]
    return {track: order[sorted_tracks == track] for track in np.unique(sorted_tracks).tolist()}


def _even_sample(points: Points, weight: float) -> tuple[Points, Points]:
    """A random sample of even density, and the larger sample that it was taken from.

    Two samples share `MAX_POINTS` by their weights, so that their mean has the same precision.
    """
    from scipy.spatial import cKDTree

    count = max(round(MAX_POINTS * weight), 1)
    if len(points) <= count:
        return points, points
    rng = np.random.default_rng(0)
    cloud = points[rng.permutation(len(points))[: CLOUD_FACTOR * count]]
    distance = cKDTree(cloud).query(cloud, k=DENSITY_NEIGHBORS + 1)[0][:, -1]
    # Weighted sampling without replacement: the largest u^(1/w) (Efraimidis and Spirakis 2006).
    keys = np.log(rng.random(len(cloud))) / np.maximum(distance**2, np.finfo(np.float32).tiny)
    return cloud[np.sort(np.argsort(keys, kind="stable")[-count:])], cloud
