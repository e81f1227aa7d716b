"""Nearest neighbours among few points, compiled by numba: import this module late.

For some hundred points that move again and again, as a sample of an organ does, a tree is soon out
of date, and asking it takes longer than looking along the organ's longest axis.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.geometry.compiled import compiled

FEW = 50  # points after which a cloud may be found to be too far off

Floats = NDArray[np.floating]  # float64
Ints = NDArray[np.integer]  # int64
Line = tuple[int, Ints, Floats]  # (n, 3) points along an axis: which, their order, and they in it


@compiled
def nearest(queries: Floats, points: Floats) -> tuple[Floats, Ints]:
    """(q,) distances from (q, 3) places to the nearest of (n, 3) points, and which those are."""
    target = line(points)
    return nearest_on(line_along(queries, target[0]), target, np.inf)


@compiled
def line(points: Floats) -> Line:
    """Points in their order along their longest extent."""
    axis, longest = 0, -1.0
    for k in range(3):
        extent = points[:, k].max() - points[:, k].min()
        if extent > longest:
            axis, longest = k, extent
    return line_along(points, axis)


@compiled
def line_along(points: Floats, axis: int) -> Line:
    """Points in their order along an axis."""
    order = np.argsort(points[:, axis])
    lined = np.empty((len(points), 3))
    for i in range(len(points)):
        for k in range(3):
            lined[i, k] = points[order[i], (axis + k) % 3]
    return axis, order, lined


@compiled
def nearest_on(queries: Line, points: Line, beyond: float) -> tuple[Floats, Ints]:
    """As `nearest`, of both along one axis.

    beyond: where it is by so much beyond the least of all distances, a distance is inf.
    """
    away, found = np.empty(len(queries[1])), np.empty(len(queries[1]), np.int64)
    apart, places = _nearest(queries[2], points[2], beyond)
    for i in range(len(apart)):
        away[queries[1][i]], found[queries[1][i]] = apart[i], points[1][places[i]]
    return away, found


@compiled
def _nearest(queries: Floats, points: Floats, beyond: float) -> tuple[Floats, Ints]:
    """As `nearest_on`, of (q, 3) and (n, 3) in their order along the first axis.

    Points are looked at from the place on to both sides, as far as the nearest one so far.
    """
    count, low, bound = len(points), 0, np.inf
    away, found = np.full(len(queries), np.inf), np.zeros(len(queries), np.int64)
    for q in range(len(queries)):
        x, y, z = queries[q, 0], queries[q, 1], queries[q, 2]
        while low < count and points[low, 0] < x:
            low += 1
        least, best = bound, -1
        before, after = low - 1, low
        while before >= 0 or after < count:
            if after < count:
                u, v, w = points[after, 0] - x, points[after, 1] - y, points[after, 2] - z
                if u * u > least:
                    after = count
                else:
                    squared = u * u + v * v + w * w
                    if squared < least:
                        least, best = squared, after
                    after += 1
            if before >= 0:
                u, v, w = points[before, 0] - x, points[before, 1] - y, points[before, 2] - z
                if u * u > least:
                    before = -1
                else:
                    squared = u * u + v * v + w * w
                    if squared < least:
                        least, best = squared, before
                    before -= 1
        if best >= 0:
            away[q], found[q] = np.sqrt(least), best
            # Rounding must not leave out what is just as far beyond.
            bound = min(bound, (1.0 + 1e-9) * (away[q] + beyond) ** 2)
    return away, found


@compiled
def nearest_cloud(clouds: Floats, end: Floats, some: Floats, prices: Floats) -> int:
    """Which of (c, n, 3) clouds comes nearest to an end (m, 3), times its price (c,).

    What counts is the mean distance of a cloud's points to the end's and of `some` (s, 3) of the
    end's to it.
    """
    target = line(end)
    asked = line_along(some, target[0])[2]
    best, least = 0, np.inf
    for c in np.argsort(prices):
        most, gap, first = least / prices[c], 0.0, 0
        cloud = line_along(clouds[c], target[0])[2]
        while first < len(cloud) and gap < most:
            part = cloud[first : first + FEW]
            gap += _nearest(part, target[2], np.inf)[0].sum() / len(cloud)
            first += FEW
        if gap < most:
            gap += _nearest(asked, cloud, np.inf)[0].mean()
        if gap < most:
            best, least = c, gap * prices[c]
    return best
