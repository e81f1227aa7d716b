"""An organ drawn to what bears it, instant by instant; compiled by numba: import this module late.

The paths of all movers of an organ change at once, and only few of them, those near the bearer, are
looked at for it: the loops over them would be short, and Python's calls around them long.

What is near is found by balls. Points that follow one another are passed over together where the
ball around them is too far off: large balls, about as many as each has points, and the small ones
in each, so that the work grows with the points and not with their pairs. It is fast where
neighbours lie side by side, as along a Morton curve.

All this is one file: numba, which keeps machine code by file, does not see that another changes.
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from baker.compiled import compiled

LEAST = 16  # points in a small ball

Floats = NDArray[np.floating]  # float64
Ints = NDArray[np.integer]  # int64
Number = TypeVar("Number", np.int64, np.float64)


@compiled
def along(curve: Floats, movers: Ints, weights: Floats) -> tuple[Floats, Floats]:
    """(I, n, 3) positions of some movers at I instants, and the balls around them.

    curve: (degree + 1, N, 3) control points; weights: (I, degree + 1) theirs at each instant.
    """
    positions = np.zeros((len(weights), len(movers), 3))
    for k in range(len(weights)):
        for i in range(len(movers)):
            for point in range(len(curve)):
                for axis in range(3):
                    positions[k, i, axis] += weights[k, point] * curve[point, movers[i], axis]
    return positions, balls(positions)


@compiled
def beside(
    mine: Floats, theirs: Floats, my_balls: Floats, their_balls: Floats, margin: float, most: int
) -> tuple[Floats, Ints, Ints]:
    """(I,) the gaps between moving clouds, and which points of either are near the other.

    mine, theirs: (I, a, 3) and (I, b, 3); my_balls, their_balls: of both.
    margin: how far beyond an instant's gap is near.
    most:   points of either side at an instant that count, the nearest ones.
    """
    gaps = closest(mine, theirs, my_balls, their_balls)[0]
    instants = len(gaps)
    near, nearby = np.empty(instants * most, np.int64), np.empty(instants * most, np.int64)
    count, other = 0, 0
    for k in range(instants):
        reach = (1.0 + 1e-9) * gaps[k] + margin
        found = _some(*within(mine[k], theirs[k], my_balls[k], their_balls[k], reach, most), most)
        own = mine[k][found].copy().reshape((1, len(found), 3))
        around = balls(own)[0]
        met = _some(*within(theirs[k], own[0], their_balls[k], around, reach, most), most)
        near[count : count + len(found)] = found
        nearby[other : other + len(met)] = met
        count, other = count + len(found), other + len(met)
    return gaps, np.unique(near[:count]), np.unique(nearby[:other])


@compiled
def _some(found: Ints, away: Floats, most: int) -> Ints:
    """Of those found the `most` nearest where they are more; of ties an even share.

    Movers that start from one point of a bud are all as far off there.
    """
    if len(found) <= most:
        return found
    farthest = np.sort(away)[most - 1]
    tied = found[away == farthest]
    chosen = np.empty(most, np.int64)
    size = 0
    for i in range(len(found)):
        if away[i] < farthest:
            chosen[size] = found[i]
            size += 1
    left = most - size
    for k in range(left):
        chosen[size + k] = tied[k * len(tied) // left]
    return chosen


@compiled
def follow(
    curve: Floats,
    mine: Ints,
    bearer: Floats,
    theirs: Ints,
    weights: Floats,
    gap: float,
    allowed: float,
    left: float,
    rounds: int,
    gentle: float,
    span: float,
) -> tuple[Floats, bool, Floats, Ints, Ints]:
    """The organ drawn to its bearer in up to so many rounds, in each one at the worst instant.

    curve, bearer: (degree + 1, N, 3) float32 control points of both, of one degree, which is 2 or
             more where there are rounds; mine, theirs: the movers of either that are looked at.
    weights: (I, degree + 1) of control points at each instant.
    gap:     at the scans; allowed: beyond it; left: beyond it where the organ is drawn.
    gentle:  the weight at least of the inner control points; span: share of the organ that follows.

    Returns the control points with the smallest largest gap that was seen, whether they are other
    ones, the gaps at all instants, and which movers of either are nearest to each other there.
    """
    there, around = along(bearer, theirs, weights)
    best, changed = curve, False
    here, balls_here = along(curve, mine, weights)
    gaps, first, second = closest(here, there, balls_here, around)
    now, now_first, now_second = gaps, first, second
    for _ in range(rounds):
        worst = int(np.argmax(now))
        if now[worst] <= gap + allowed:
            break
        base, touched = mine[now_first[worst]], there[worst, now_second[worst]]
        curve = _shifted(curve, base, touched, weights[worst], now[worst], gap + left, gentle, span)
        here, balls_here = along(curve, mine, weights)
        now, now_first, now_second = closest(here, there, balls_here, around)
        if now.max() < gaps.max():
            best, changed = curve, True
            gaps, first, second = now, now_first, now_second
    return best, changed, gaps, mine[first], theirs[second]


@compiled
def _shifted(
    curve: Floats,
    base: int,
    touched: Floats,
    weights: Floats,
    gap: float,
    kept: float,
    gentle: float,
    span: float,
) -> Floats:
    """Movers drawn at one instant to a point that their base is too far from.

    They follow their base the less the farther they are from it, and nothing moves at the scans.
    """
    last, count = len(curve) - 1, curve.shape[1]
    points = np.zeros((count, 3))
    for point in range(len(curve)):
        for i in range(count):
            for axis in range(3):
                points[i, axis] += weights[point] * curve[point, i, axis]
    middle = np.zeros(3)
    for i in range(count):
        middle += points[i]
    middle /= count
    size = 0.0
    for i in range(count):
        for axis in range(3):
            size += (points[i, axis] - middle[axis]) ** 2
    size = max(span * span * size / count, 1e-30)
    inner = max(weights[1:last].sum(), gentle)
    way = (touched - points[base]) * (1.0 - kept / gap) / inner
    shifted = curve.copy()
    for i in range(count):
        away = 0.0
        for axis in range(3):
            away += (points[i, axis] - points[base, axis]) ** 2
        share = np.exp(-away / size)
        for point in range(1, last):
            for axis in range(3):
                shifted[point, i, axis] = curve[point, i, axis] + share * way[axis]
    return shifted


@compiled
def balls(points: Floats) -> Floats:
    """(I, B, 4) balls around successive points of (I, n, 3) clouds: their centres and radii.

    The large ones come first, then the small ones, `LEAST` points in each.
    """
    instants, count = points.shape[0], points.shape[1]
    large = _large(count)
    found = np.empty((instants, large + -(-count // LEAST), 4))
    for k in range(instants):
        for ball in range(found.shape[1]):
            size = _size(count) if ball < large else LEAST
            first = (ball if ball < large else ball - large) * size
            last = min(first + size, count)
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
    large, other = _large(len(mine)), _large(len(theirs))
    # The two balls whose middles are nearest give a first bound.
    nearest, p, q = np.inf, 0, 0
    for a in range(large):
        for b in range(other):
            squared = _squared(my_balls, a, their_balls, b)
            if squared < nearest:
                nearest, p, q = squared, a, b
    found = np.inf, 0, 0
    for a in range(-1, large):
        for b in range(-1 if a < 0 else 0, 0 if a < 0 else other):
            one, two = (p, q) if a < 0 else (a, b)
            if _apart(my_balls, one, their_balls, two, found[0]):
                continue
            for small in _within(one, len(mine)):
                if _apart(my_balls, small, their_balls, two, found[0]):
                    continue
                for least in _within(two, len(theirs)):
                    if not _apart(my_balls, small, their_balls, least, found[0]):
                        first, second = (small - large) * LEAST, (least - other) * LEAST
                        found = _closer(mine, theirs, first, second, found)
    return found


@compiled
def _closer(
    mine: Floats, theirs: Floats, first: int, second: int, found: tuple[float, int, int]
) -> tuple[float, int, int]:
    """The nearest of the pairs between two small balls, if it is nearer than the one so far."""
    reach, own, other = found
    least = reach * reach
    for i in range(first, min(first + LEAST, len(mine))):
        px, py, pz = mine[i, 0], mine[i, 1], mine[i, 2]
        for j in range(second, min(second + LEAST, len(theirs))):
            x, y, z = px - theirs[j, 0], py - theirs[j, 1], pz - theirs[j, 2]
            squared = x * x + y * y + z * z
            if squared < least:
                least, own, other = squared, i, j
                reach = np.sqrt(squared)
    return reach, own, other


@compiled
def within(
    mine: Floats, theirs: Floats, my_balls: Floats, their_balls: Floats, reach: float, most: int
) -> tuple[Ints, Floats]:
    """Which points are within reach of theirs, and (w,) their distances to the nearest of them.

    mine, theirs: (a, 3) and (b, 3), at one instant; my_balls, their_balls: of both.
    most: of more points only those that are as near as the one of this rank.

    In their order. Most points are far off, and nothing is written down for them.
    """
    size, other = _size(len(mine)), _large(len(theirs))
    found, away = np.empty(size, np.int64), np.empty(size)
    beside = np.empty(other, np.int64)
    count, full = 0, 2 * most
    for a in range(_large(len(mine))):
        count_beside = 0
        for b in range(other):
            if not _apart(my_balls, a, their_balls, b, reach):
                beside[count_beside] = b
                count_beside += 1
        if count_beside == 0:
            continue
        if count + size > len(found):
            found, away = _longer(found, 2 * (count + size)), _longer(away, 2 * (count + size))
        nearest = np.inf
        for i in range(a * size, min((a + 1) * size, len(mine))):
            # Movers that start from one point of a bud are in one place there.
            if i == a * size or _squared(mine, i, mine, i - 1) > 0.0:
                nearest = _nearest(mine[i], theirs, their_balls, beside[:count_beside], reach)
            if nearest <= reach:
                found[count], away[count] = i, nearest
                count += 1
        if count >= full:
            # Rounding must not leave out points that are as near.
            reach = np.sort(away[:count])[most - 1] * (1.0 + 1e-9)
            count = _kept(found, away, count, reach)
            full = max(2 * most, 2 * count)
    if count > most:
        count = _kept(found, away, count, np.sort(away[:count])[most - 1])
    return found[:count].copy(), away[:count].copy()


@compiled
def _nearest(
    point: Floats, theirs: Floats, their_balls: Floats, beside: Ints, reach: float
) -> float:
    """The distance to the nearest of the points in some of their large balls; inf beyond reach."""
    large = _large(len(theirs))
    least, bound, near = reach * reach, reach, False
    for b in beside:
        if _beyond(point, their_balls, b, bound):
            continue
        for small in _within(b, len(theirs)):
            if _beyond(point, their_balls, small, bound):
                continue
            nearest = np.inf
            first = (small - large) * LEAST
            for j in range(first, min(first + LEAST, len(theirs))):
                x, y, z = point[0] - theirs[j, 0], point[1] - theirs[j, 1], point[2] - theirs[j, 2]
                nearest = min(nearest, x * x + y * y + z * z)
            if nearest <= least:
                least, bound, near = nearest, np.sqrt(nearest), True
    return bound if near else np.inf


@compiled
def _kept(found: Ints, away: Floats, count: int, reach: float) -> int:
    """How many of those found are within reach; they move up to the front, in their order."""
    kept = 0
    for i in range(count):
        if away[i] <= reach:
            found[kept], away[kept] = found[i], away[i]
            kept += 1
    return kept


@compiled
def _longer(values: NDArray[Number], count: int) -> NDArray[Number]:
    longer = np.empty(count, values.dtype)
    longer[: len(values)] = values
    return longer


@compiled
def _size(count: int) -> int:
    """Points in a large ball: as many as there are such balls, whole small ones."""
    return LEAST * max(1, int(np.sqrt(count)) // LEAST)


@compiled
def _large(count: int) -> int:
    """How many large balls there are."""
    return -(-count // _size(count))


@compiled
def _within(ball: int, count: int) -> range:
    """The small balls within a large one."""
    inside, large = _size(count) // LEAST, _large(count)
    return range(
        large + ball * inside, min(large + (ball + 1) * inside, large + -(-count // LEAST))
    )


@compiled
def _apart(a: Floats, i: int, b: Floats, j: int, reach: float) -> bool:
    """Whether two balls are farther apart than some reach."""
    beyond = reach + a[i, 3] + b[j, 3]
    return _squared(a, i, b, j) > beyond * beyond


@compiled
def _beyond(point: Floats, ball: Floats, i: int, reach: float) -> bool:
    """Whether a ball is farther from a point than some reach."""
    x, y, z = point[0] - ball[i, 0], point[1] - ball[i, 1], point[2] - ball[i, 2]
    beyond = reach + ball[i, 3]
    return x * x + y * y + z * z > beyond * beyond


@compiled
def _squared(a: Floats, i: int, b: Floats, j: int) -> float:
    x, y, z = a[i, 0] - b[j, 0], a[i, 1] - b[j, 1], a[i, 2] - b[j, 2]
    return x * x + y * y + z * z
