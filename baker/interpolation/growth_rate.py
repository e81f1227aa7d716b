"""How far an organ has come half-way through an interval, as the intervals beside it foretell.

What grows comes to rest by and by: half-way in time it is beyond the half of its way. Two scans
don't say so, the next ones do, wherever an organ keeps its direction. What sways turns from scan to
scan, and goes evenly. Where an organ is and how large it is have each a pace of their own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from baker.matching import IntervalOrgans, Match

# Cosine of an organ's ways in two intervals from which on, and at which, one foretells the other.
KEPT, SURE = 0.9, 1.0
# The same of the usual organ that moves, at least: else the plant sways, and what goes on does so
# by chance. Either or: were it by degrees, one more scan would change every interval a little.
STEADY = 0.95
MOST = 0.25  # of the way: beyond that a path of degree two would turn back
MOVES = 1.0  # point spacings; what goes less far stands, and has no direction
MATTERS = 0.1  # point spacings; less is below what the scan shows

FEWEST = 20  # points that tell an organ's size

Vector = NDArray[np.float64]
Known = dict[int, Vector]  # by organ, its way, or what it grows by


@dataclass(frozen=True)
class Pace:
    """How far beyond the half of its way an organ is half-way; negative where it gets faster.

    way: (3,) of its middle; ahead: a share of that; growing: a share of the rest of a point's way.
    """

    way: Vector
    ahead: float
    growing: float

    def shift(self, start: NDArray[np.floating], end: NDArray[np.floating]) -> Vector:
        """(N, 3) how far movers between these points are from the middle half-way."""
        rest = np.asarray(end, float) - start - self.way
        shift: Vector = self.ahead * self.way + self.growing * rest
        return shift


def paces(
    clouds: Sequence[NDArray[np.floating]],
    matches: Sequence[Match],
    organs: Sequence[IntervalOrgans],
    times: Sequence[float],
    spacing: float,
) -> list[dict[int, Pace]]:
    """For each interval, by organ, at which pace it goes.

    clouds: (N, 3) each; times: of the scans; spacing: of their points.

    Those that go evenly are left out.
    """
    known = [
        _known(clouds[k : k + 2], match, named)
        for k, (match, named) in enumerate(zip(matches, organs, strict=True))
    ]
    ways, growths = [way for way, _ in known], [growth for _, growth in known]
    kept = [
        _cosine(way, following[organ])
        for before, following in pairwise(ways)
        for organ, way in before.items()
        if organ in following
        and min(np.linalg.norm(way), np.linalg.norm(following[organ])) > MOVES * spacing
    ]
    if not kept or np.median(kept) < STEADY:
        return [{} for _ in ways]
    spans = [float(span) for span in np.diff(times)]
    found: list[dict[int, Pace]] = []
    for k, known_ways in enumerate(ways):
        found.append({})
        for organ, way in known_ways.items():
            ahead = _ahead(ways, spans, k, organ)
            growing = _ahead(growths, spans, k, organ, growth=True)
            far = abs(ahead) * np.linalg.norm(way)
            grown = abs(growing) * np.linalg.norm(growths[k].get(organ, np.zeros(1)))
            if max(far, grown) > MATTERS * spacing:
                found[k][organ] = Pace(way, ahead, growing)
    return found


def _known(
    clouds: Sequence[NDArray[np.floating]], match: Match, organs: IntervalOrgans
) -> tuple[Known, Known]:
    """For each matched organ (3,) the way of its middle, and (1,) what its radius grows by."""
    ways, growths = {}, {}
    for a, b in match.pairs:
        first, second = match.first.segments[a], match.second.segments[b]
        if len(first) and len(second):
            before, after = (
                cloud.take(members, axis=0).astype(float)
                for cloud, members in zip(clouds, (first, second), strict=True)
            )
            organ = organs.second[b]
            ways[organ] = after.mean(axis=0) - before.mean(axis=0)
            if min(len(first), len(second)) >= FEWEST:
                growths[organ] = np.array([_radius(after) - _radius(before)])
    return ways, growths


def _radius(points: NDArray[np.float64]) -> float:
    return float(np.sqrt(points.var(axis=0).sum()))


def _ahead(
    known: Sequence[Known], spans: Sequence[float], k: int, organ: int, growth: bool = False
) -> float:
    """How far beyond the half of interval k's way an organ is half-way, of the way.

    growth: whether that is what it grows by. An organ grows slowly at first and at last.

    A cubic path from 0 to 1 is at 1/2 + (v - w) / 8 half-way, v and w its speeds at the ends.
    """
    if organ not in known[k]:
        return 0.0
    first, last = (
        _faster(known[k][organ], spans[k], known[n][organ], spans[n])
        if 0 <= n < len(known) and organ in known[n]
        else None
        for n in (k - 1, k + 1)
    )
    if first is None and last is None:
        return 0.0
    # At the series' ends speeds go on to change as they do at the interval's other scan; but what
    # grows the faster the nearer it is to an end has been slower beyond, or will be.
    first = _beyond(last, growth) if first is None else first
    last = _beyond(first, growth) if last is None else last
    return float(np.clip((first - last) / 8, -MOST, MOST))


def _beyond(inner: float | None, growth: bool) -> float:
    """By how much faster an organ is at an end of the series, as a share."""
    assert inner is not None
    return min(-inner, 0.0) if growth else -inner


def _faster(way: Vector, span: float, other: Vector, long: float) -> float:
    """By how much faster an organ is at a scan than on its way to or from it, as a share.

    other, long: its way on the scan's other side, and how long it takes.

    At the scan it has the weighted harmonic mean of both speeds (F. N. Fritsch and J. Butland, A
    Method for Constructing Local Monotone Piecewise Cubic Interpolants, SIAM Journal on Scientific
    and Statistical Computing 5, 1984), as far as it keeps its direction.
    """
    own, speed = float(np.linalg.norm(way)) / span, float(np.linalg.norm(other)) / long
    if own == 0 or speed == 0:
        return 0.0
    there, here = long + 2 * span, 2 * long + span
    mean = (there + here) / (there / speed + here / own)
    return _between(_cosine(way, other), KEPT, SURE) * (mean / own - 1)


def _cosine(way: Vector, other: Vector) -> float:
    """0 where either is none."""
    lengths = float(np.linalg.norm(way) * np.linalg.norm(other))
    return float(way @ other) / lengths if lengths > 0 else 0.0


def _between(value: float, none: float, all_of: float) -> float:
    """0 up to the one, 1 from the other on."""
    return float(np.clip((value - none) / (all_of - none), 0.0, 1.0))
