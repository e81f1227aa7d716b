"""Predict where organs are on their paths at mid-interval, from the intervals before and after.

Growth slows down, so at mid-interval an organ is usually beyond the middle of its path. This can be
estimated from the neighbouring intervals if the organ keeps its direction of motion. Organs that
sway change their direction from scan to scan, and are assumed to move evenly.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from baker.matching import Match

# Cosine of an organ's displacements in two intervals: below the first, its speeds are not related,
# at the second they are (docs/method.md, "Motion of organs").
MIN_COSINE, FULL_COSINE = 0.9, 1.0
# The median of all organs: below it the plant sways, and organs keep their direction by chance. It
# is a threshold and not a weight, so that another scan does not change all intervals.
MIN_MEDIAN_COSINE = 0.95
MAX_OFFSET = 0.25  # in displacements; with more, a curve of degree 2 would turn back
MIN_DISPLACEMENT = 1.0  # in point spacings, of organs that have a direction of motion
MIN_SHIFT = 0.1  # in point spacings; smaller ones can't be seen
MIN_POINTS_FOR_RADIUS = 20

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Timing:
    """How far beyond the middle of its path an organ is at mid-interval."""

    displacement: Vector  # (3,) of the organ's centroid
    offset: float  # of the centroid, as a share of its displacement
    radial_offset: float  # of growth about the centroid, as a share of the relative displacement

    def shift(self, start: NDArray[np.floating], end: NDArray[np.floating]) -> Vector:
        """(N, 3) offsets of movers between these points from the middle of their paths."""
        relative = np.asarray(end, float) - start - self.displacement
        return np.asarray(self.offset * self.displacement + self.radial_offset * relative)


def organ_timings(
    clouds: Sequence[NDArray[np.floating]],
    matches: Sequence[Match],
    times: Sequence[float],
    spacing: float,
) -> list[dict[int, Timing]]:
    """Estimate how far organs are beyond the middle of their paths at mid-interval.

    spacing: point spacing of the scans. Returns a timing by organ for each interval; organs that
    move evenly are left out.

    References
    ----------
    F. N. Fritsch and J. Butland (1984), A Method for Constructing Local Monotone Piecewise Cubic
    Interpolants: the speed at a scan is a weighted harmonic mean of the speeds before and after.
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
    """Matched organ -> (3,) displacement of its centroid; organ -> (1,) increase of its radius."""
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
    """The offset of an organ at mid-interval beyond half of its change, as a share of the change.

    A cubic path from 0 to 1 is at 1/2 + (v - w) / 8 in the middle, with speeds v and w at its ends.
    At the ends of the series, the acceleration is continued from the other scan of the interval, up
    to `limit`.
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
    """The relative difference between the speed of an organ at a scan and in an adjacent interval.

    other, other_span: displacement and duration of the interval on the other side of the scan.
    """
    speed = float(np.linalg.norm(displacement)) / span
    other_speed = float(np.linalg.norm(other)) / other_span
    if speed == 0 or other_speed == 0:
        return 0.0
    weight, other_weight = 2 * other_span + span, other_span + 2 * span
    mean = (weight + other_weight) / (weight / speed + other_weight / other_speed)
    trust = np.interp(_cosine(displacement, other), (MIN_COSINE, FULL_COSINE), (0.0, 1.0))
    return float(trust) * (mean / speed - 1)


def _cosine(first: Vector, second: Vector) -> float:
    """The cosine of the angle between two vectors; 0 if one is zero."""
    lengths = float(np.linalg.norm(first) * np.linalg.norm(second))
    return float(first @ second) / lengths if lengths > 0 else 0.0
