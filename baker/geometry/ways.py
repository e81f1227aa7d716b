"""Shortest ways through a cloud, from neighbour to neighbour, compiled by numba: import this late.

Of some hundred points a sparse matrix would take longer to make than their ways to find.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.geometry.compiled import compiled

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Links = tuple[Ints, Ints, Floats]  # of point v: the other ends [first[v] : first[v + 1]], lengths


@compiled
def links(points: Floats, near: Ints, bridges: Ints) -> Links:
    """The neighbour graph of (n, 3) points, each link once at either end, other ends in order.

    near: (n, k) the neighbours of each, or itself; bridges: (b, 2) further links.
    """
    n, k = near.shape
    pairs, made = np.empty((len(bridges) + n * k, 2), np.int64), len(bridges)
    for b in range(made):
        pairs[b, 0], pairs[b, 1] = bridges[b, 0], bridges[b, 1]
    for one in range(n):
        for c in range(k):
            other = near[one, c]
            # Where two are each other's neighbours, the first one makes the link.
            if other > one or (other < one and not _among(near, other, one)):
                pairs[made, 0], pairs[made, 1] = one, other
                made += 1
    first = np.zeros(n + 1, np.int64)
    for link in range(made):
        first[pairs[link, 0] + 1] += 1
        first[pairs[link, 1] + 1] += 1
    for point in range(n):
        first[point + 1] += first[point]
    unordered, place = np.empty(2 * made, np.int64), first.copy()
    for link in range(made):
        one, other = pairs[link, 0], pairs[link, 1]
        unordered[place[one]], unordered[place[other]] = other, one
        place[one] += 1
        place[other] += 1
    ends, lengths, place = np.empty(2 * made, np.int64), np.empty(2 * made), first.copy()
    for one in range(n):
        for link in range(first[one], first[one + 1]):
            other = unordered[link]
            ends[place[other]], lengths[place[other]] = one, _length(points, one, other)
            place[other] += 1
    return first, ends, lengths


@compiled
def _among(near: Ints, point: int, other: int) -> bool:
    found = False
    for c in range(near.shape[1]):
        found = found or near[point, c] == other
    return found


@compiled
def ways(points: Floats, links: Links, seeds: Ints, heads: Floats) -> tuple[Floats, Ints]:
    """(n,) the lengths of the shortest ways to (n, 3) points, and (b, 2) bridges that they take.

    links: between the points; seeds: where ways begin; heads: (seeds,) what they are long there.

    What links do not lead to is joined by the shortest gap, one part of the cloud after the other.
    """
    n = len(points)
    first, ends, lengths = links
    way = np.full(n, np.inf)
    # A point whose way gets shorter waits, in a ring, for those of its neighbours to be looked at.
    ring, waiting, begin, count = np.empty(n, np.int64), np.zeros(n, np.bool_), 0, 0
    for k in range(len(seeds)):
        point = seeds[k]
        way[point] = min(way[point], heads[k])
        if not waiting[point]:
            ring[count], waiting[point] = point, True
            count += 1
    gap, across, joined = np.full(n, np.inf), np.zeros(n, np.int64), np.zeros(n, np.bool_)
    bridges, made = np.empty((n, 2), np.int64), 0
    while True:
        while count > 0:
            point = ring[begin]
            waiting[point] = False
            begin, count = (begin + 1) % n, count - 1
            for link in range(first[point], first[point + 1]):
                other, length = ends[link], way[point] + lengths[link]
                if length < way[other]:
                    way[other] = length
                    if not waiting[other]:
                        ring[(begin + count) % n], waiting[other] = other, True
                        count += 1
        lonely = np.flatnonzero(way == np.inf)
        if len(lonely) == 0:
            return way, bridges[:made]
        nearest = lonely[0]
        for point in range(n):
            if way[point] < np.inf and not joined[point]:
                joined[point] = True
                for other in lonely:
                    length = _length(points, point, other)
                    if length < gap[other]:
                        gap[other], across[other] = length, point
        for other in lonely:
            if gap[other] < gap[nearest]:
                nearest = other
        way[nearest] = way[across[nearest]] + gap[nearest]
        bridges[made] = across[nearest], nearest
        ring[begin], waiting[nearest], count, made = nearest, True, 1, made + 1


@compiled
def _length(points: Floats, one: int | np.integer, other: int | np.integer) -> float:
    u = points[one, 0] - points[other, 0]
    v = points[one, 1] - points[other, 1]
    w = points[one, 2] - points[other, 2]
    return float(np.sqrt(u * u + v * v + w * w))
