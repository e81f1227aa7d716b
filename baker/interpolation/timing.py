"""Where an organ is half-way through an interval, as the intervals before and after tell.

What grows comes to rest by and by: half-way in time it is beyond the middle of its path. Two scans
don't tell that, the next ones do, wherever an organ keeps its direction. What sways changes its
direction from scan to scan, and moves evenly.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from baker.matching import IntervalOrgans, Match

# Cosines of an organ's displacements in two intervals from which on, and at which, one predicts the
# other (docs/method.md, "Timing").
MIN_COSINE, FULL_COSINE = 0.9, 1.0
# The same of the median organ: below it the plant sways, and what keeps its direction does so by
# chance. A threshold: by degrees one more scan would change every interval a little.
MIN_MEDIAN_COSINE = 0.95
MAX_OFFSET = 0.25  # of the displacement: beyond it a path of degree two would turn back
MIN_DISPLACEMENT = 1.0  # point spacings; what moves less has no direction
MIN_SHIFT = 0.1  # point spacings; less is below what a scan shows

Vector = NDArray[np.float64]


def timing_shifts(
    clouds: Sequence[NDArray[np.floating]],
    matches: Sequence[Match],
    organs: Sequence[IntervalOrgans],
    times: Sequence[float],
    spacing: float,
) -> list[dict[int, Vector]]:
    """How far organs are from the middle of their paths half-way in time.

    Parameters
    ----------
    clouds : sequence of (N, 3) float
        The scans' points.
    matches, organs
        Of each interval.
    times : sequence of float
        Of the scans.
    spacing : float
        Point spacing of the scans, in their unit.

    Returns
    -------
    list of dict
        For each interval, by organ, (3,) float64; organs that move evenly are left out.

    References
    ----------
    F. N. Fritsch and J. Butland, A Method for Constructing Local Monotone Piecewise Cubic
    Interpolants, SIAM Journal on Scientific and Statistical Computing 5, 1984: an organ's speed at
    a scan is the weighted harmonic mean of those before and after.
    """
    moved = [
        _displacements(clouds[k : k + 2], match, named)
        for k, (match, named) in enumerate(zip(matches, organs, strict=True))
    ]
    cosines = [
        _cosine(way, following[organ])
        for before, following in pairwise(moved)
        for organ, way in before.items()
        if organ in following
        and min(np.linalg.norm(way), np.linalg.norm(following[organ])) > MIN_DISPLACEMENT * spacing
    ]
    if not cosines or np.median(cosines) < MIN_MEDIAN_COSINE:
        return [{} for _ in moved]
    spans = [float(span) for span in np.diff(times)]
    shifts = [
        {organ: _offset(moved, spans, k, organ) * way for organ, way in known.items()}
        for k, known in enumerate(moved)
    ]
    return [
        {organ: s for organ, s in one.items() if np.linalg.norm(s) > MIN_SHIFT * spacing}
        for one in shifts
    ]


def _displacements(
    clouds: Sequence[NDArray[np.floating]], match: Match, organs: IntervalOrgans
) -> dict[int, Vector]:
    """(3,) of the middle of each matched organ."""
    found = {}
    for a, b in match.pairs:
        before, after = match.first.segments[a], match.second.segments[b]
        if len(before) and len(after):
            middles = (
                cloud.take(points, axis=0).mean(axis=0, dtype=np.float64)
                for cloud, points in zip(clouds, (before, after), strict=True)
            )
            start, end = middles
            found[organs.second[b]] = end - start
    return found


def _offset(
    moved: Sequence[dict[int, Vector]], spans: Sequence[float], k: int, organ: int
) -> float:
    """How far beyond the middle of its path an organ is half-way, as a share of its displacement.

    A cubic path from 0 to 1 is at 1/2 + (v - w) / 8 half-way, v and w its speeds at the ends.
    """
    first, last = (
        _acceleration(moved[k][organ], spans[k], moved[n][organ], spans[n])
        if 0 <= n < len(moved) and organ in moved[n]
        else None
        for n in (k - 1, k + 1)
    )
    if first is None and last is None:
        return 0.0
    # At the series' ends speeds go on to change as they do at the interval's other scan.
    if first is None:
        first = -last if last is not None else 0.0
    elif last is None:
        last = -first
    assert last is not None
    return float(np.clip((first - last) / 8, -MAX_OFFSET, MAX_OFFSET))


def _acceleration(way: Vector, span: float, other: Vector, other_span: float) -> float:
    """By how much faster an organ is at a scan than in the interval before or after it, as a share.

    way, span: its displacement in that interval, and the interval's length; other, other_span:
    those on the scan's other side.
    """
    speed, other_speed = (
        float(np.linalg.norm(way)) / span,
        float(np.linalg.norm(other)) / other_span,
    )
    if speed == 0 or other_speed == 0:
        return 0.0
    weight, other_weight = 2 * other_span + span, other_span + 2 * span
    mean = (weight + other_weight) / (weight / speed + other_weight / other_speed)
    trust = (_cosine(way, other) - MIN_COSINE) / (FULL_COSINE - MIN_COSINE)
    return float(np.clip(trust, 0.0, 1.0)) * (mean / speed - 1)


def _cosine(one: Vector, other: Vector) -> float:
    """0 where either has no length."""
    lengths = float(np.linalg.norm(one) * np.linalg.norm(other))
    return float(one @ other) / lengths if lengths > 0 else 0.0
