"""Nearest neighbours among few points, compiled by numba: import this module late.

For some hundred points that move again and again, as a sample of an organ does, a tree is soon out
of date, and asking it takes longer than looking along the organ's longest axis.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.compiled import compiled

Floats = NDArray[np.floating]  # float64
Ints = NDArray[np.integer]  # int64


@compiled
def nearest(queries: Floats, points: Floats) -> tuple[Floats, Ints]:
    """(q,) distances from (q, 3) places to the nearest of (n, 3) points, and which those are.

    Points are looked at in their order along their longest extent, from the place on to both
    sides, as far as the nearest one so far.
    """
    count = len(points)
    axis, longest = 0, -1.0
    for k in range(3):
        extent = points[:, k].max() - points[:, k].min()
        if extent > longest:
            axis, longest = k, extent
    order = np.argsort(points[:, axis])
    lined = np.empty((count, 3))
    for i in range(count):
        for k in range(3):
            lined[i, k] = points[order[i], (axis + k) % 3]
    away, found = np.empty(len(queries)), np.empty(len(queries), np.int64)
    for q in range(len(queries)):
        x, y, z = (queries[q, axis], queries[q, (axis + 1) % 3], queries[q, (axis + 2) % 3])
        low, high = 0, count
        while low < high:
            middle = (low + high) // 2
            if lined[middle, 0] < x:
                low = middle + 1
            else:
                high = middle
        least, best = np.inf, 0
        before, after = low - 1, low
        while before >= 0 or after < count:
            if after < count:
                u, v, w = lined[after, 0] - x, lined[after, 1] - y, lined[after, 2] - z
                if u * u > least:
                    after = count
                else:
                    squared = u * u + v * v + w * w
                    if squared < least:
                        least, best = squared, after
                    after += 1
            if before >= 0:
                u, v, w = lined[before, 0] - x, lined[before, 1] - y, lined[before, 2] - z
                if u * u > least:
                    before = -1
                else:
                    squared = u * u + v * v + w * w
                    if squared < least:
                        least, best = squared, before
                    before -= 1
        away[q], found[q] = np.sqrt(least), order[best]
    return away, found


@compiled
def gaps(clouds: Floats, end: Floats, some: Floats) -> Floats:
    """(c,) how near each of (c, n, 3) clouds comes to an end (m, 3).

    The mean distance of a cloud's points to the end's, and of `some` (s, 3) of the end's to it.
    """
    found = np.empty(len(clouds))
    for c in range(len(clouds)):
        cloud = clouds[c]
        found[c] = nearest(cloud, end)[0].mean() + nearest(some, cloud)[0].mean()
    return found
