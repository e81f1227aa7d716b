"""How far an organ has come half-way through an interval, as the intervals beside it foretell.

What grows comes to rest by and by: half-way in time it is beyond the half of its way. Two scans
don't say so, the next ones do, wherever an organ keeps its direction. What sways turns from scan to
scan, and goes evenly.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from baker.match import IntervalOrgans, Match

# Cosine of an organ's ways in two intervals from which on, and at which, one foretells the other.
KEPT, SURE = 0.9, 1.0
# The same of the usual organ that moves: else the plant sways, and what goes on does so by chance.
STEADY = 0.9, 0.97
MOST = 0.25  # of the way: beyond that a path of degree two would turn back
OPEN = 0.5  # of the change at an interval's one scan that is likely at the series' end, too
MOVES = 1.0  # point spacings; what goes less far stands, and has no direction
MATTERS = 0.1  # point spacings; less is below what the scan shows

Way = NDArray[np.float64]


def paces(
    clouds: Sequence[NDArray[np.floating]],
    matches: Sequence[Match],
    organs: Sequence[IntervalOrgans],
    times: Sequence[float],
    spacing: float,
) -> list[dict[int, float]]:
    """For each interval, by organ, how far beyond the half of its way it is half-way, of the way.

    clouds: (N, 3) each; times: of the scans; spacing: of their points.

    Negative where an organ comes to be faster. Those that go evenly are left out.
    """
    ways = [
        _ways(clouds[k : k + 2], match, named)
        for k, (match, named) in enumerate(zip(matches, organs, strict=True))
    ]
    spans = np.diff(times)
    kept = [
        _cosine(way, following[organ])
        for known, following in pairwise(ways)
        for organ, way in known.items()
        if organ in following
        and min(np.linalg.norm(way), np.linalg.norm(following[organ])) > MOVES * spacing
    ]
    if not kept:
        return [{} for _ in ways]
    steady = _between(float(np.median(kept)), *STEADY)
    found: list[dict[int, float]] = []
    for k, known in enumerate(ways):
        beside = [
            (ways[n], float(spans[n])) if 0 <= n < len(ways) else None for n in (k - 1, k + 1)
        ]
        found.append({})
        for organ, way in known.items():
            before, after = (
                (side[0][organ], side[1]) if side and organ in side[0] else None for side in beside
            )
            ahead = steady * _ahead(way, float(spans[k]), before, after)
            if abs(ahead) * np.linalg.norm(way) > MATTERS * spacing:
                found[k][organ] = ahead
    return found


def _ways(
    clouds: Sequence[NDArray[np.floating]], match: Match, organs: IntervalOrgans
) -> dict[int, Way]:
    """(3,) for each matched organ, the mean way of its points."""
    ways = {}
    for a, b in match.pairs:
        first, second = match.first.segments[a], match.second.segments[b]
        if len(first) and len(second):
            before = clouds[0][first].mean(axis=0, dtype=float)
            ways[organs.second[b]] = clouds[1][second].mean(axis=0, dtype=float) - before
    return ways


def _ahead(
    way: Way, span: float, before: tuple[Way, float] | None, after: tuple[Way, float] | None
) -> float:
    """How far beyond the half of its way an organ is half-way, whose speeds at the scans agree.

    before, after: the ways in the intervals beside this one, and how long these take.

    A cubic path from 0 to 1 is at 1/2 + (v - w) / 8 half-way, v and w its speeds at the ends.
    """
    first, last = (_faster(way, span, beside) for beside in (before, after))
    if first is None and last is None:
        return 0.0
    first = -OPEN * last if first is None and last is not None else first
    last = -OPEN * first if last is None and first is not None else last
    assert first is not None
    assert last is not None
    return float(np.clip((first - last) / 8, -MOST, MOST))


def _faster(way: Way, span: float, beside: tuple[Way, float] | None) -> float | None:
    """By how much faster an organ is at a scan than on the way to or from it, as a share.

    At a scan it has the weighted harmonic mean of the speeds on both sides (F. N. Fritsch and
    J. Butland, A Method for Constructing Local Monotone Piecewise Cubic Interpolants, SIAM Journal
    on Scientific and Statistical Computing 5, 1984), as far as it keeps its direction. None where
    the other side is not known.
    """
    if beside is None:
        return None
    other, long = beside
    own, speed = float(np.linalg.norm(way)) / span, float(np.linalg.norm(other)) / long
    if own == 0 or speed == 0:
        return 0.0
    there, here = long + 2 * span, 2 * long + span
    mean = (there + here) / (there / speed + here / own)
    return _between(_cosine(way, other), KEPT, SURE) * (mean / own - 1)


def _cosine(way: Way, other: Way) -> float:
    """0 where either is none."""
    lengths = float(np.linalg.norm(way) * np.linalg.norm(other))
    return float(way @ other) / lengths if lengths > 0 else 0.0


def _between(value: float, none: float, all_of: float) -> float:
    """0 up to the one, 1 from the other on."""
    return float(np.clip((value - none) / (all_of - none), 0.0, 1.0))
