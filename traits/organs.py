"""The points of each organ of a clip at a time, as evenly sampled as the scans themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gclip.evaluate import layers_at, locate, positions_on_curve

if TYPE_CHECKING:
    from gclip import Clip

Points = NDArray[np.float64]

MAX_POINTS = 2500  # of an organ; where there are more, a random sample of them is measured
CLOUD_FACTOR = 8  # times as many points tell where the surface lies
DENSITY_NEIGHBORS = 8  # the distance to this neighbour estimates the local density


class Organ(NamedTuple):
    """The points of an organ at a time, relative to the clip's origin.

    Attributes
    ----------
    points : ndarray of shape (N, 3)
        Points to measure.
    cloud : ndarray of shape (M, 3)
        The points that they are a sample of.
    mixed : float
        0 where all points come from one scan, 1 where half of them come from each of two.
    seen : bool
        Whether the preceding scan shows the organ; the size of any other is a guess.
    known : float
        0 in the interval before the organ is first seen, rising to 1 at that scan.
    """

    points: Points
    cloud: Points
    mixed: float = 0.0
    seen: bool = True
    known: float = 1.0


class Sample(NamedTuple):
    """Organs by track id, and the weight of what is measured on them, in (0, 1]."""

    weight: float
    organs: dict[int, Organ]


def samples_at(clip: Clip, day: float) -> list[Sample]:
    """Sample the organs of a clip at a time.

    Several movers may share a start or an end point. One sample keeps one mover a start point, the
    other one mover an end point; at a scan's own time the sample is that scan. Between
    scans both are measured and weighted by time, so that no trait jumps at a scan. A newborn organ
    starts from its attachment points, which are no scan of it: both samples use its end points.

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
    weights = (1.0 - passed, passed)
    moved: set[int] = set()
    parts: tuple[dict[int, list[Points]], dict[int, list[Points]]] = ({}, {})
    for layer in layers_at(clip, day):
        if layer.litter:
            continue
        interval, movers = (
            clip.intervals[layer.interval],
            slice(layer.group.first, layer.group.stop),
        )
        now = positions_on_curve(interval, movers, layer.parameter).astype(np.float64)
        tracks, ends = (
            np.asarray(interval.tracks[movers]),
            np.asarray(interval.end_positions[movers]),
        )
        newborn = born[tracks] > begin
        starts = np.where(newborn[:, None], ends, interval.start_positions[movers])
        moved |= {track for track in np.unique(tracks[~newborn]).tolist() if lost[track] != begin}
        for kept, weight, places in zip(parts, weights, (starts, ends), strict=True):
            if weight:
                for track, chosen in _distinct(tracks, places).items():
                    kept.setdefault(track, []).append(now[chosen])
    mixed = 4.0 * passed * (1.0 - passed)
    return [
        Sample(
            weight,
            {
                track: Organ(
                    *_sample(np.concatenate(part), weight),
                    mixed=mixed if track in moved else 0.0,
                    seen=bool(born[track] <= begin) or passed == 1.0,
                    known=passed if born[track] == begin else float(born[track] < begin),
                )
                for track, part in kept.items()
            },
        )
        for kept, weight in zip(parts, weights, strict=True)
        if weight
    ]


def _distinct(tracks: NDArray[np.integer], places: NDArray) -> dict[int, NDArray[np.intp]]:
    """For each track, the indices of movers whose (N, 3) places differ, the first of each place."""
    order = np.lexsort((*places.T[::-1], tracks))
    of, at, first = tracks[order], places[order], np.ones(len(order), bool)
    first[1:] = (of[1:] != of[:-1]) | (at[1:] != at[:-1]).any(axis=1)
    order, of = order[first], of[first]
    return {track: order[of == track] for track in np.unique(of).tolist()}


def _sample(points: Points, weight: float) -> tuple[Points, Points]:
    """A random sample whose density is even, and the larger sample that it was taken from.

    Two samples share `MAX_POINTS` by their weights: their mean is as sure as all of these in one.
    """
    from scipy.spatial import cKDTree

    most = max(round(MAX_POINTS * weight), 1)
    if len(points) <= most:
        return points, points
    rng = np.random.default_rng(0)
    cloud = points[rng.permutation(len(points))[: CLOUD_FACTOR * most]]
    distance = cKDTree(cloud).query(cloud, k=DENSITY_NEIGHBORS + 1)[0][:, -1]
    # Weighted sampling without replacement: the largest u^(1/w) (Efraimidis and Spirakis 2006).
    order = np.log(rng.random(len(cloud))) / np.maximum(distance**2, np.finfo(np.float32).tiny)
    return cloud[np.sort(np.argsort(order, kind="stable")[-most:])], cloud
