"""The nearest neighbours of every point of a cloud, compiled by numba: import this module late.

Where points come in an order that keeps together what lies together, that order is a search tree.
It is asked for some points at once: what lies together has nearly the same neighbours.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.compiled import compiled

LEAF = 8  # points at most that are looked at together

Floats = NDArray[np.floating]  # float64
Ints = NDArray[np.integer]


@compiled
def neighbours(points: Floats, count: int) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """(n, count) squared distances to the nearest other points of each, and which; nearest first.

    points: (n, 3) along a bisection or a Morton curve; in other orders this is slow.
    count:  at least 1; a point with fewer others has itself, at an infinite distance.
    """
    n, depth = len(points), 0
    while n >> depth > LEAF:
        depth += 1
    leaves = 1 << depth
    first = np.empty(leaves + 1, np.int64)
    for leaf in range(leaves + 1):
        first[leaf] = -(-leaf * n // leaves)
    box = _boxes(points, first)
    away, near = np.full((n, count), np.inf), np.empty((n, count), np.int32)
    for i in range(n):
        near[i] = i
    waiting = np.empty(depth + 2, np.int64)
    for leaf in range(leaves):
        # Itself first, then what is beside it, then what is beside both, and so on.
        part, beside, bound = leaves + leaf, leaves + leaf, np.inf
        own = box[part]
        while part > 0:
            waiting[0], left = beside, 1
            while left > 0:
                left -= 1
                other = waiting[left]
                if _apart(box[other], own[0], own[1], own[2], own[3], own[4], own[5]) > bound:
                    continue
                if other < leaves:
                    waiting[left], waiting[left + 1] = 2 * other, 2 * other + 1
                    left += 2
                    continue
                bound = 0.0
                begin, end = first[other - leaves], first[other - leaves + 1]
                for i in range(first[leaf], first[leaf + 1]):
                    x, y, z = points[i, 0], points[i, 1], points[i, 2]
                    if _apart(box[other], x, y, z, x, y, z) < away[i, -1]:
                        _look(points, i, begin, end, away[i], near[i])
                    bound = max(bound, away[i, -1])
            part, beside = part >> 1, part ^ 1
    return away, near


@compiled
def _look(points: Floats, i: int, begin: int, end: int, away: Floats, near: Ints) -> None:
    """Puts those of the points from `begin` to `end` that are nearer to i among its neighbours."""
    x, y, z = points[i, 0], points[i, 1], points[i, 2]
    farthest = away[-1]
    for j in range(begin, end):
        u, v, w = points[j, 0] - x, points[j, 1] - y, points[j, 2] - z
        squared = u * u + v * v + w * w
        if squared < farthest and j != i:
            place = len(away) - 1
            while place > 0 and away[place - 1] > squared:
                away[place], near[place] = away[place - 1], near[place - 1]
                place -= 1
            away[place], near[place] = squared, j
            farthest = away[-1]


@compiled
def _boxes(points: Floats, first: Ints) -> Floats:
    """(2 leaves, 6) lows and highs: of leaf k at leaves + k, of p what 2 p and 2 p + 1 are in."""
    leaves = len(first) - 1
    box = np.empty((2 * leaves, 6))
    for leaf in range(leaves):
        for axis in range(3):
            low, high = np.inf, -np.inf
            for i in range(first[leaf], first[leaf + 1]):
                low, high = min(low, points[i, axis]), max(high, points[i, axis])
            box[leaves + leaf, axis], box[leaves + leaf, 3 + axis] = low, high
    for part in range(leaves - 1, 0, -1):
        for axis in range(3):
            box[part, axis] = min(box[2 * part, axis], box[2 * part + 1, axis])
            box[part, 3 + axis] = max(box[2 * part, 3 + axis], box[2 * part + 1, 3 + axis])
    return box


@compiled
def _apart(
    box: Floats, left: float, front: float, low: float, right: float, back: float, high: float
) -> float:
    """The squared gap between a box and another one."""
    u = max(0.0, max(box[0] - right, left - box[3]))
    v = max(0.0, max(box[1] - back, front - box[4]))
    w = max(0.0, max(box[2] - high, low - box[5]))
    return u * u + v * v + w * w
