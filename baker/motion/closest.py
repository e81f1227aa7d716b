"""Where two moving clouds are near each other, compiled by numba: import this module late.

Points that follow one another are passed over together where the ball around them is too far off:
about as many of them as there are such balls, so that the work grows with the points and not with
their pairs. It is fast where neighbours lie side by side, as along a Morton curve.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.compiled import compiled

LEAST = 16  # points in a ball

Floats = NDArray[np.floating]  # float64
Ints = NDArray[np.integer]  # int64


@compiled
def balls(points: Floats) -> Floats:
    """(I, B, 4) balls around successive points of (I, n, 3) clouds: their centres and radii."""
    instants, count = points.shape[0], points.shape[1]
    size = _size(count)
    found = np.empty((instants, -(-count // size), 4))
    for k in range(instants):
        for ball in range(found.shape[1]):
            first, last = ball * size, min((ball + 1) * size, count)
            x, y, z = 0.0, 0.0, 0.0
            for i in range(first, last):
                x, y, z = x + points[k, i, 0], y + points[k, i, 1], z + points[k, i, 2]
            x, y, z = x / (last - first), y / (last - first), z / (last - first)
            found[k, ball, 0], found[k, ball, 1], found[k, ball, 2] = x, y, z
            widest = 0.0
            for i in range(first, last):
                widest = max(widest, _squared(points[k, i], found[k, ball]))
            # Rounding must not leave a point outside.
            found[k, ball, 3] = np.sqrt(widest) * (1.0 + 1e-9)
    return found


@compiled
def closest(
    mine: Floats, theirs: Floats, my_balls: Floats, their_balls: Floats
) -> tuple[Floats, Ints, Ints]:
    """(I,) distances and indices of the pair nearest to each other at each of I instants.

    mine, theirs: (I, a, 3) and (I, b, 3); my_balls, their_balls: of both, as `balls` finds them.

    All pairs count.
    """
    instants = len(mine)
    gap = np.empty(instants)
    first, second = np.zeros(instants, np.int64), np.zeros(instants, np.int64)
    for k in range(instants):
        gap[k], first[k], second[k] = _closest(mine[k], theirs[k], my_balls[k], their_balls[k])
    return gap, first, second


@compiled
def _closest(
    mine: Floats, theirs: Floats, my_balls: Floats, their_balls: Floats
) -> tuple[float, int, int]:
    size, other = _size(len(mine)), _size(len(theirs))
    # The two balls whose middles are nearest give a first bound.
    nearest, p, q = np.inf, 0, 0
    for a in range(len(my_balls)):
        for b in range(len(their_balls)):
            squared = _squared(my_balls[a], their_balls[b])
            if squared < nearest:
                nearest, p, q = squared, a, b
    least, first, second = np.inf, 0, 0
    reach = np.inf
    for a in range(-1, len(my_balls)):
        for b in range(-1 if a < 0 else 0, 0 if a < 0 else len(their_balls)):
            one, two = (p, q) if a < 0 else (a, b)
            beyond = reach + my_balls[one, 3] + their_balls[two, 3]
            if _squared(my_balls[one], their_balls[two]) > beyond * beyond:
                continue
            for i in range(one * size, min((one + 1) * size, len(mine))):
                beyond = reach + their_balls[two, 3]
                if _squared(mine[i], their_balls[two]) > beyond * beyond:
                    continue
                px, py, pz = mine[i, 0], mine[i, 1], mine[i, 2]
                for j in range(two * other, min((two + 1) * other, len(theirs))):
                    x, y, z = px - theirs[j, 0], py - theirs[j, 1], pz - theirs[j, 2]
                    squared = x * x + y * y + z * z
                    if squared < least:
                        least, first, second = squared, i, j
                        reach = np.sqrt(squared)
    return reach, first, second


@compiled
def distances(
    mine: Floats, theirs: Floats, my_balls: Floats, their_balls: Floats, reach: float
) -> Floats:
    """(a,) each point's distance to the nearest of theirs, infinity where none is within reach.

    mine, theirs: (a, 3) and (b, 3), at one instant; my_balls, their_balls: of both.
    """
    size, other = _size(len(mine)), _size(len(theirs))
    found = np.full(len(mine), reach * reach)
    near = np.zeros(len(mine), np.bool_)
    for a in range(len(my_balls)):
        for b in range(len(their_balls)):
            beyond = reach + my_balls[a, 3] + their_balls[b, 3]
            if _squared(my_balls[a], their_balls[b]) > beyond * beyond:
                continue
            radius = their_balls[b, 3]
            for i in range(a * size, min((a + 1) * size, len(mine))):
                away = _squared(mine[i], their_balls[b])
                if away > (reach + radius) ** 2:
                    continue
                for j in range(b * other, min((b + 1) * other, len(theirs))):
                    squared = _squared(mine[i], theirs[j])
                    if squared <= found[i]:
                        found[i], near[i] = squared, True
    return np.where(near, np.sqrt(found), np.inf)


@compiled
def _size(count: int) -> int:
    return max(LEAST, int(np.sqrt(count)))


@compiled
def _squared(a: Floats, b: Floats) -> float:
    x, y, z = a[0] - b[0], a[1] - b[1], a[2] - b[2]
    return x * x + y * y + z * z
