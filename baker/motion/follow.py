"""An organ drawn to what bears it, instant by instant; compiled by numba: import this module late.

The paths of all movers of an organ change at once, and only few of them, those near the bearer, are
looked at for it: the loops over them would be short, and Python's calls around them long.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.compiled import compiled
from baker.motion.closest import balls, closest, within

Floats = NDArray[np.floating]
Ints = NDArray[np.integer]  # int64


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
        found = _nearest(*within(mine[k], theirs[k], my_balls[k], their_balls[k], reach), most)
        own = mine[k][found].copy().reshape((1, len(found), 3))
        around = balls(own)[0]
        met = _nearest(*within(theirs[k], own[0], their_balls[k], around, reach), most)
        near[count : count + len(found)] = found
        nearby[other : other + len(met)] = met
        count, other = count + len(found), other + len(met)
    return gaps, np.unique(near[:count]), np.unique(nearby[:other])


@compiled
def _nearest(found: Ints, away: Floats, most: int) -> Ints:
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
