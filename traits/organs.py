"""Which points each organ of a clip has at a time, spread as evenly as its scans' points."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from gclip import Clip, Interval
    from gclip.evaluate import Layer

Points = NDArray[np.float64]

MOST = 2500  # points of an organ that are measured; a fair sample of them where there are more
CLOUD = 8  # times as many that tell where the surface is
DENSITY = 8  # neighbours that tell how densely points lie


class Organ(NamedTuple):
    """(N, 3) points to measure, and the (M, 3) they are a sample of; about the clip's origin.

    mixed: how much of the points is of one scan and how much of another, 0 (all of one) to 1.
    seen:  no later than at the scan before; how large others are until the next, nobody knows.
    known: 0 until an organ is seen, 1 from the next scan on.
    """

    points: Points
    cloud: Points
    mixed: float = 0.0
    seen: bool = True
    known: float = 1.0


class Sample(NamedTuple):
    """Organs by track, and how much what is measured on them counts, in (0, 1]."""

    weight: float
    organs: dict[int, Organ]


def samples_at(clip: Clip, day: float) -> list[Sample]:
    """The organs at a time, from one or two samples whose weights sum to 1.

    Several movers may share a point at either end. In one sample, of those that start together one
    counts, in the other, of those that end together: at a scan, the one left is that scan. In
    between both are measured, and the nearer scan's counts more: so no measure jumps at a scan.
    Organs that are born start as a bud, which is no scan: they are told by their ends.
    """
    from gclip.evaluate import layers_at, locate

    index, passed = locate(clip, day)
    begin = clip.intervals[index].start
    born = {track.id: track.born for track in clip.track_table}
    lost = {track.id: track.lost for track in clip.track_table}
    weights = (1.0 - passed, passed)
    moved: set[int] = set()
    parts: tuple[dict[int, list[Points]], dict[int, list[Points]]] = ({}, {})
    for layer in layers_at(clip, day):
        if layer.litter:
            continue
        interval = clip.intervals[layer.interval]
        for track, now, start, end in _moving(interval, layer):
            newborn = born[track] > begin
            if not newborn and lost[track] != begin:
                moved.add(track)
            for kept, weight, given in zip(parts, weights, (start, end), strict=True):
                if weight:
                    kept.setdefault(track, []).append(now[end if newborn else given])
    mixed = 4.0 * passed * (1.0 - passed)
    return [
        Sample(
            weight,
            {
                track: Organ(
                    *_sample(np.concatenate(part)),
                    mixed=mixed if track in moved else 0.0,
                    seen=born[track] <= begin or passed == 1.0,
                    known=passed if born[track] == begin else float(born[track] < begin),
                )
                for track, part in kept.items()
            },
        )
        for kept, weight in zip(parts, weights, strict=True)
        if weight
    ]


def _moving(
    interval: Interval, layer: Layer
) -> list[tuple[int, Points, NDArray[np.intp], NDArray[np.intp]]]:
    """Of each track of a layer: where its movers are, and which differ in start, and in end."""
    from gclip.evaluate import positions_on_curve

    movers = slice(layer.group.first, layer.group.stop)
    now = positions_on_curve(interval, movers, layer.parameter).astype(np.float64)
    tracks = np.asarray(interval.tracks[movers])
    found = []
    for track in np.unique(tracks).tolist():
        own = np.flatnonzero(tracks == track)
        start, end = (
            np.unique(np.asarray(places[movers][own]), axis=0, return_index=True)[1]
            for places in (interval.start_positions, interval.end_positions)
        )
        found.append((track, now[own], start, end))
    return found


def _sample(points: Points) -> tuple[Points, Points]:
    """A sample, and what it was taken from: as even as may be, where points lie twice as densely,
    half of them are taken.
    """
    from scipy.spatial import cKDTree

    if len(points) <= MOST:
        return points, points
    rng = np.random.default_rng(0)
    cloud = points[rng.permutation(len(points))[: CLOUD * MOST]]
    apart = cKDTree(cloud).query(cloud, k=DENSITY + 1)[0][:, -1]
    # The largest of u^(1/w) are a sample with weights w (Efraimidis and Spirakis 2006).
    order = np.log(rng.random(len(cloud))) / np.maximum(apart**2, np.finfo(float).tiny)
    return cloud[np.sort(np.argsort(order, kind="stable")[-MOST:])], cloud
