"""What a plant measures at a time: each organ, and the whole."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from measure.axis import axis_of
from measure.surface import area, smoothed

if TYPE_CHECKING:
    from gclip import Clip

HALVES = 4  # samples of half of an organ's points that tell what its hull still lacks
LACKING = 1.35  # of what half the points lack more: volume falls short by about count^-0.8
MOST = 2500  # points of an organ that are measured; a fair sample of them where there are more


@dataclass(frozen=True)
class Measurement:
    """One organ, or with track None the whole plant, at one time. Lengths in the clip's unit;
    None where there are too few points to tell, or where a plant has no such thing.

    height: of the highest point above the plant's lowest.
    length: along the axis, from the attachment to the tip.
    area:   of the scanned surface: of a leaf one side, where both were scanned both.
    hull:   volume of the convex hull of the surface, not of its points alone.
    angle:  degrees between the vertical and the first quarter of the axis.
    """

    time: float
    track: int | None
    points: int
    height: float
    length: float | None
    area: float | None
    hull: float | None
    angle: float | None


def measure(clip: Clip, day: float, only: Collection[int] | None = None) -> list[Measurement]:
    """The whole plant, then its organs by track, at a time.

    Organs that are being lost count as long as they are part of the plant. What was born between
    two scans is a bud at the first of them, which did not see it: there it does not count.

    only: the tracks to measure, without the whole plant; None for all.
    """
    born = {track.id: track.born for track in clip.track_table}
    parents = {track.id: track.parent for track in clip.track_table}
    needed = born.keys() if only is None else {*only, *(parents.get(track) for track in only)}
    organs = {
        track: smoothed(_sample(points))
        for track, points in _organs_at(clip, day).items()
        if track in needed and (day not in clip.times or born[track] <= day)
    }
    up = _up(clip.up)
    floor = _floor(clip)
    nothing = np.zeros((0, 3))
    found = [
        _organ(day, track, points, organs.get(parents.get(track), nothing), up, floor)  # type: ignore[arg-type]
        for track, points in sorted(organs.items())
        if only is None or track in only
    ]
    if only is not None or not found:
        return found
    whole = np.concatenate(list(organs.values()))
    areas = [one.area for one in found if one.area is not None]
    plant = Measurement(
        time=day,
        track=None,
        points=sum(one.points for one in found),
        height=max(one.height for one in found),
        length=None,
        area=sum(areas) if areas else None,
        hull=_hull(whole),
        angle=None,
    )
    return [plant, *found]


def _organ(
    day: float,
    track: int,
    points: NDArray[np.float64],
    parent: NDArray[np.float64],
    up: NDArray[np.float64],
    floor: float,
) -> Measurement:
    axis = axis_of(points, parent, up)
    return Measurement(
        time=day,
        track=track,
        points=len(points),
        height=float((points @ up).max()) - floor,
        length=None if axis is None else axis.length,
        area=area(points) or None,
        hull=_hull(points),
        angle=None if axis is None else axis.angle(up),
    )


def _organs_at(clip: Clip, day: float) -> dict[int, NDArray[np.float64]]:
    """Each organ's points, about the clip's origin, as evenly spread as its scans' points were.

    Several movers may share a point at either end. So of those that start together one counts,
    or of those that end together, whichever leaves an organ more.
    """
    from gclip.evaluate import layers_at, positions_on_curve

    parts: dict[int, list[NDArray[np.float64]]] = {}
    for layer in layers_at(clip, day):
        if layer.litter:
            continue
        interval = clip.intervals[layer.interval]
        movers = slice(layer.group.first, layer.group.stop)
        now = positions_on_curve(interval, movers, layer.parameter).astype(np.float64)
        tracks = np.asarray(interval.tracks[movers])
        for track in np.unique(tracks).tolist():
            own = np.flatnonzero(tracks == track)
            apart = [
                np.unique(np.asarray(end[movers][own]), axis=0, return_index=True)[1]
                for end in (interval.start_positions, interval.end_positions)
            ]
            begun, done = (layer.parameter == end for end in (0.0, 1.0))
            kept = apart[0] if begun else apart[1] if done else max(apart, key=len)
            parts.setdefault(track, []).append(now[own[np.sort(kept)]])
    return {track: np.concatenate(points) for track, points in parts.items()}


def _sample(points: NDArray[np.float64]) -> NDArray[np.float64]:
    if len(points) <= MOST:
        return points
    return points[np.random.default_rng(0).permutation(len(points))[:MOST]]


def _floor(clip: Clip) -> float:
    """Height of the root's foot in the first scan: heights of all days are measured from there."""
    first = clip.at(clip.times[0])
    height = first.local.astype(np.float64) @ _up(clip.up)
    root = next((track.id for track in clip.track_table if track.parent is None), 0)
    own = height[first.tracks == root]
    return float(np.quantile(own if len(own) else height, 0.01))


def _up(up: str) -> NDArray[np.float64]:
    direction = np.zeros(3)
    direction["xyz".index(up[-1])] = -1.0 if up.startswith("-") else 1.0
    return direction


def _hull(points: NDArray[np.float64]) -> float | None:
    """The convex hull's volume of what (N, 3) points were scattered on; None where they lie in one
    plane or are too few.

    The hull of points falls short of the hull of what they lie on: at faces by count^-1, at borders
    by count^-0.5. How short, the hulls of halves of them tell (Richardson's extrapolation).
    """
    from scipy.spatial import ConvexHull, QhullError

    rng, half = np.random.default_rng(0), len(points) // 2
    parts = [points[rng.permutation(len(points))[:half]] for _ in range(HALVES)]
    try:
        whole = float(ConvexHull(points).volume)
        return whole + LACKING * (whole - float(np.mean([ConvexHull(p).volume for p in parts])))
    except (QhullError, ValueError):
        return None
