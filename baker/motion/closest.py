"""Where two moving clouds are near each other, compiled by numba: import this module late.

Points that follow one another are passed over together where the ball around them is too far off:
about as many of them as there are such balls, so that the work grows with the points and not with
their pairs. It is fast where neighbours lie side by side, as along a Morton curve.
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from baker.compiled import compiled

LEAST = 16  # points in a ball

Floats = NDArray[np.floating]  # float64
Ints = NDArray[np.integer]  # int64
Number = TypeVar("Number", np.int64, np.float64)


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
                widest = max(widest, _squared(points[k], i, found[k], ball))
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
            squared = _squared(my_balls, a, their_balls, b)
            if squared < nearest:
                nearest, p, q = squared, a, b
    least, first, second = np.inf, 0, 0
    reach = np.inf
    for a in range(-1, len(my_balls)):
        for b in range(-1 if a < 0 else 0, 0 if a < 0 else len(their_balls)):
            one, two = (p, q) if a < 0 else (a, b)
            beyond = reach + my_balls[one, 3] + their_balls[two, 3]
            if _squared(my_balls, one, their_balls, two) > beyond * beyond:
                continue
            for i in range(one * size, min((one + 1) * size, len(mine))):
                beyond = reach + their_balls[two, 3]
                if _squared(mine, i, their_balls, two) > beyond * beyond:
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
def within(
    mine: Floats, theirs: Floats, my_balls: Floats, their_balls: Floats, reach: float
) -> tuple[Ints, Floats]:
    """Which points are within reach of theirs, and (w,) their distances to the nearest of them.

    mine, theirs: (a, 3) and (b, 3), at one instant; my_balls, their_balls: of both.

    In their order. Most points are far off, and nothing is written down for them.
    """
    size, other = _size(len(mine)), _size(len(theirs))
    found, away = np.empty(size, np.int64), np.empty(size)
    beside = np.empty(len(their_balls), np.int64)
    count = 0
    for a in range(len(my_balls)):
        count_beside = 0
        for b in range(len(their_balls)):
            beyond = reach + my_balls[a, 3] + their_balls[b, 3]
            if _squared(my_balls, a, their_balls, b) <= beyond * beyond:
                beside[count_beside] = b
                count_beside += 1
        if count_beside == 0:
            continue
        if count + size > len(found):
            found, away = _longer(found, 2 * (count + size)), _longer(away, 2 * (count + size))
        for i in range(a * size, min((a + 1) * size, len(mine))):
            x, y, z = mine[i, 0], mine[i, 1], mine[i, 2]
            least, bound, near = reach * reach, reach, False
            for place in range(count_beside):
                b = beside[place]
                beyond = bound + their_balls[b, 3]
                if _squared(mine, i, their_balls, b) > beyond * beyond:
                    continue
                nearest = np.inf
                for j in range(b * other, min((b + 1) * other, len(theirs))):
                    u, v, w = x - theirs[j, 0], y - theirs[j, 1], z - theirs[j, 2]
                    nearest = min(nearest, u * u + v * v + w * w)
                if nearest <= least:
                    least, bound, near = nearest, np.sqrt(nearest), True
            if near:
                found[count], away[count] = i, bound
                count += 1
    return found[:count].copy(), away[:count].copy()


@compiled
def _longer(values: NDArray[Number], count: int) -> NDArray[Number]:
    longer = np.empty(count, values.dtype)
    longer[: len(values)] = values
    return longer


@compiled
def _size(count: int) -> int:
    return max(LEAST, int(np.sqrt(count)))


@compiled
def _squared(a: Floats, i: int, b: Floats, j: int) -> float:
    x, y, z = a[i, 0] - b[j, 0], a[i, 1] - b[j, 1], a[i, 2] - b[j, 2]
    return x * x + y * y + z * z
