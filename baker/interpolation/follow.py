"""An organ drawn to what bears it, at one instant after the other.

The paths of all movers of an organ change at once. The loops over them are compiled by numba:
import this module late.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.geometry.compiled import compiled

Floats = NDArray[np.floating]  # float64
Ints = NDArray[np.integer]  # int64
Moving = tuple[Floats, Floats, Floats]  # control points, balls and weights, as in `beside`


def follow(
    curve: Floats,
    weights: Floats,
    bearer: Moving,
    apart: tuple[Floats, Ints, Ints],
    allowed: float,
    fine: float,
    left: float,
    rounds: int,
    gentle: float,
    span: float,
) -> tuple[Floats, float]:
    """The organ drawn to its bearer in up to so many rounds, in each one at the worst instant.

    curve:   (degree + 1, N, 3) float32 control points of the organ, of degree 2 or more; weights:
             (I, degree + 1) of these at each instant.
    apart:   (I,) how far both are from each other, and which movers of either are.
    allowed: gap from which on they are drawn, left: gap that is left where they are; fine: gap
             below which it does not matter who is nearest.
    gentle:  the weight at least of the inner control points; span: share of the organ that follows.

    Returns the control points with the smallest largest gap that was seen, and that gap.
    """
    from baker.interpolation.beside import balls, place_of, widest

    now, first, second = apart
    best, least = curve, float(now.max())
    for _ in range(rounds):
        worst = int(np.argmax(now))
        if now[worst] <= allowed:
            break
        base, gap = first[worst], now[worst]
        touched = np.array(place_of(bearer, worst, second[worst]))
        curve = _shifted(curve, base, touched, weights[worst], gap, left, gentle, span)
        now, first, second = widest((curve, balls(curve), weights), bearer, first, second, fine)
        if now.max() < least:
            best, least = curve, float(now.max())
    return best, least


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
