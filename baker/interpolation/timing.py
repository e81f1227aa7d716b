"""Where an organ is at mid-interval, predicted from the intervals before and after.

What grows comes to rest by and by: at mid-interval it is beyond the middle of its path. Two scans
don't show that, the next ones do, wherever an organ keeps its direction. What sways changes its
direction from scan to scan, and moves evenly.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from baker.matching import Match

# Cosines of an organ's displacements in two intervals from which on, and at which, one predicts the
# other (docs/method.md, "Timing").
MIN_COSINE, FULL_COSINE = 0.9, 1.0
# The same of the median organ: below it the plant sways, and what keeps its direction does so by
# chance. A threshold: by degrees one more scan would change every interval a little.
MIN_MEDIAN_COSINE = 0.95
MAX_OFFSET = 0.25  # of the displacement: beyond it a path of degree two would turn back
MIN_DISPLACEMENT = 1.0  # point spacings; what moves less has no direction
MIN_SHIFT = 0.1  # point spacings; less is below what a scan shows
MIN_POINTS_FOR_RADIUS = 20

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Timing:
    """How far beyond the middle of its path an organ is at mid-interval."""

    displacement: Vector  # (3,) of the organ's middle
    offset: float  # of the middle, as a share of that
    # of growth about the middle, as a share of the rest of a point's displacement
    radial_offset: float

    def shift(self, start: NDArray[np.floating], end: NDArray[np.floating]) -> Vector:
        """(N, 3) how far movers between these points are from the middle of their paths."""
        rest = np.asarray(end, float) - start - self.displacement
        return np.asarray(self.offset * self.displacement + self.radial_offset * rest)


def organ_timings(
    clouds: Sequence[NDArray[np.floating]],
    matches: Sequence[Match],
    times: Sequence[float],
    spacing: float,
) -> list[dict[int, Timing]]:
    """How far organs are beyond the middle of their paths at mid-interval.

    clouds, times: the scans' points, (N, 3), and when they were taken. spacing: point spacing of
    the scans, in their unit. Returns for each interval, by organ, its timing; organs that move
    evenly are left out.

    References
    ----------
    F. N. Fritsch and J. Butland (1984), A Method for Constructing Local Monotone Piecewise Cubic
    Interpolants: the speed at a scan is the weighted harmonic mean of those before and after.
    """
    changes = list(map(_changes, clouds, clouds[1:], matches))
    moved, grown = [change[0] for change in changes], [change[1] for change in changes]
    cosines = [
        _cosine(displacement, following[organ])
        for before, following in pairwise(moved)
        for organ, displacement in before.items()
        if organ in following
        and min(np.linalg.norm(displacement), np.linalg.norm(following[organ]))
        > MIN_DISPLACEMENT * spacing
    ]
    if not cosines or np.median(cosines) < MIN_MEDIAN_COSINE:
        return [{} for _ in moved]
    spans: list[float] = np.diff(times).tolist()
    timings: list[dict[int, Timing]] = [{} for _ in moved]
    for k, displacements in enumerate(moved):
        for organ, displacement in displacements.items():
            offset = _offset(moved, spans, k, organ, limit=np.inf)
            radial = _offset(grown, spans, k, organ, limit=0.0)
            shift = abs(offset) * np.linalg.norm(displacement)
            widening = abs(radial) * np.linalg.norm(grown[k].get(organ, 0))
            if max(shift, widening) > MIN_SHIFT * spacing:
                timings[k][organ] = Timing(displacement, offset, radial)
    return timings


def _changes(
    source: NDArray[np.floating], target: NDArray[np.floating], match: Match
) -> tuple[dict[int, Vector], dict[int, Vector]]:
    """By matched organ (3,) the displacement of its middle, and (1,) what its radius grows by."""
    moved, grown = {}, {}
    for a, b in match.pairs:
        before, after = match.first.segments[a], match.second.segments[b]
        if len(before) and len(after):
            start, end = source[before].astype(float), target[after].astype(float)
            moved[match.second.organs[b]] = end.mean(axis=0) - start.mean(axis=0)
            if min(len(start), len(end)) >= MIN_POINTS_FOR_RADIUS:
                radii = [np.sqrt(points.var(axis=0).sum()) for points in (start, end)]
                grown[match.second.organs[b]] = np.diff(radii)
    return moved, grown


def _offset(
    changes: Sequence[dict[int, Vector]], spans: Sequence[float], k: int, organ: int, limit: float
) -> float:
    """How far beyond half of its change an organ is at mid-interval, as a share of the change.

    A cubic path from 0 to 1 is at 1/2 + (v - w) / 8 in the middle, v and w its speeds at the ends.
    At the series' ends speeds go on to change as they do at the interval's other scan, up to
    `limit`: growth is slow at first and at last.
    """
    first, last = (
        _acceleration(changes[k][organ], spans[k], changes[n][organ], spans[n])
        if organ in changes[k] and 0 <= n < len(changes) and organ in changes[n]
        else None
        for n in (k - 1, k + 1)
    )
    if first is None and last is None:
        return 0.0
    if first is None:
        first = min(-(last or 0.0), limit)
    elif last is None:
        last = min(-first, limit)
    return float(np.clip((first - (last or 0.0)) / 8, -MAX_OFFSET, MAX_OFFSET))


def _acceleration(displacement: Vector, span: float, other: Vector, other_span: float) -> float:
    """By how much faster an organ is at a scan than in the interval before or after it, as a share.

    other, other_span: displacement and length of the interval on the scan's other side.
    """
    speed = float(np.linalg.norm(displacement)) / span
    other_speed = float(np.linalg.norm(other)) / other_span
    if speed == 0 or other_speed == 0:
        return 0.0
    weight, other_weight = 2 * other_span + span, other_span + 2 * span
    mean = (weight + other_weight) / (weight / speed + other_weight / other_speed)
    trust = (_cosine(displacement, other) - MIN_COSINE) / (FULL_COSINE - MIN_COSINE)
    return float(np.clip(trust, 0.0, 1.0)) * (mean / speed - 1)


def _cosine(first: Vector, second: Vector) -> float:
    """0 where either has no length."""
    lengths = float(np.linalg.norm(first) * np.linalg.norm(second))
    return float(first @ second) / lengths if lengths > 0 else 0.0
