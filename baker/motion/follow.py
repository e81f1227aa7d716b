"""An organ drawn to what bears it, at one instant after the other.

The paths of all movers of an organ change at once, and only few of them, those near the bearer, are
looked at for it. The loops over all movers are compiled by numba: import this module late.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.compiled import compiled

Floats = NDArray[np.floating]  # float64
Ints = NDArray[np.integer]  # int64


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
    from baker.motion.beside import balls, closest, place_of

    there = np.take(bearer, theirs, axis=1)
    around = balls(there)
    best, changed = curve, False
    here = np.take(curve, mine, axis=1)
    gaps, first, second = closest(here, there, balls(here), around, weights)
    now, now_first, now_second = gaps, first, second
    for _ in range(rounds):
        worst = int(np.argmax(now))
        if now[worst] <= gap + allowed:
            break
        base = mine[now_first[worst]]
        touched = np.array(place_of(there, now_second[worst], weights[worst]))
        curve = _shifted(curve, base, touched, weights[worst], now[worst], gap + left, gentle, span)
        here = np.take(curve, mine, axis=1)
        now, now_first, now_second = closest(here, there, balls(here), around, weights)
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
