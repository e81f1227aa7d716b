"""The steps of bending and drawing an organ, compiled by numba: import this module late.

Arrays of some hundred points are so small that numpy's calls would take longer than their work.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.geometry.compiled import compiled

TERMS = 22  # of a point: 1, where it is, its shift, and the products of these two with the former

Floats = NDArray[np.floating]
Ints = NDArray[np.integer]
Pairs = tuple[Floats, Ints]  # distances, and the nearest ones' indices


@compiled
def laid(
    nodes: Floats, turns: Floats, along: Floats, offset: Floats, width: float
) -> NDArray[np.float64]:
    """(c, n, 3) points laid along a spine, each of c ways turned otherwise.

    nodes: (L, 3) of the spine; turns: (c, L, 3, 3) there; between them both are read linearly.
    along: (n,) from 0 to 1; offset: (n, 3) from the spine, before turning; width: its factor.
    """
    ways, last = len(turns), len(nodes) - 1
    found = np.empty((ways, len(along), 3))
    for i in range(len(along)):
        place = along[i] * last
        before = min(int(place), last - 1)
        share = place - before
        for c in range(ways):
            one, two = turns[c, before], turns[c, before + 1]
            for a in range(3):
                turned = 0.0
                for b in range(3):
                    turned += ((1.0 - share) * one[a, b] + share * two[a, b]) * offset[i, b]
                node = (1.0 - share) * nodes[before, a] + share * nodes[before + 1, a]
                found[c, i, a] = node + width * turned
    return found


@compiled
def terms(here: Floats, there: Floats, ahead: Pairs, back: Pairs, doubtful: float) -> Floats:
    """(n, TERMS) float32: what each of (n, 3) points adds to sums around it, with all its pairs.

    ahead:    for each point the nearest one of `there` (m, 3); back: for each of those the nearest.
    doubtful: median distances from which a pair counts less than half.
    """
    count = len(here)
    scale = doubtful * np.median(np.concatenate((ahead[0], back[0])))
    mass, pull = np.zeros(count), np.zeros((count, 3))
    for k in range(count + len(there)):
        point = k if k < count else back[1][k - count]
        partner = ahead[1][k] if k < count else k - count
        away = ahead[0][k] if k < count else back[0][k - count]
        trust = 1.0 / (1.0 + (away / scale) ** 2) if scale > 0.0 else 1.0
        mass[point] += trust
        for axis in range(3):
            pull[point, axis] += trust * (there[partner, axis] - here[point, axis])
    found = np.empty((count, TERMS), np.float32)
    for i in range(count):
        found[i, 0] = mass[i]
        for a in range(3):
            found[i, 1 + a] = mass[i] * here[i, a]
            found[i, 4 + a] = pull[i, a]
            for b in range(3):
                found[i, 13 + 3 * a + b] = here[i, a] * pull[i, b]
            for b in range(a + 1):
                found[i, 7 + a * (a + 1) // 2 + b] = mass[i] * here[i, a] * here[i, b]
    return found


@compiled
def maps(sums: Floats, stiff: float) -> Floats:
    """(c, 12) float32: around each of c centres shift = point @ slopes + offset, by least squares.

    sums:  (c, TERMS) of the points' `terms`, weighted; stiff: what holds back slopes, per mass.

    The nine slopes come first, row after row, then the offset.
    """
    found = np.empty((len(sums), 12), np.float32)
    second, cross = np.empty((3, 3)), np.empty((3, 3))
    for c in range(len(sums)):
        total = float(sums[c, 0])
        for a in range(3):
            first = float(sums[c, 1 + a])
            for b in range(3):
                cross[a, b] = sums[c, 13 + 3 * a + b] - first * sums[c, 4 + b] / total
            for b in range(a + 1):
                entry = sums[c, 7 + a * (a + 1) // 2 + b] - first * sums[c, 1 + b] / total
                second[a, b] = second[b, a] = entry
            second[a, a] += stiff * total
        _solve(second, cross)
        for b in range(3):
            offset = sums[c, 4 + b] / total
            for a in range(3):
                offset -= sums[c, 1 + a] / total * cross[a, b]
                found[c, 3 * a + b] = cross[a, b]
            found[c, 9 + b] = offset
    return found


@compiled
def _solve(left: Floats, right: Floats) -> None:
    """Solves left @ x = right, (3, 3) both and left positive definite, and puts x in `right`."""
    for k in range(3):
        for row in range(3):
            if row != k:
                share = left[row, k] / left[k, k]
                for column in range(3):
                    left[row, column] -= share * left[k, column]
                    right[row, column] -= share * right[k, column]
    for k in range(3):
        for column in range(3):
            right[k, column] /= left[k, k]


@compiled
def mapped(points: Floats, local: Floats) -> Floats:
    """(n, 3) points, each shifted by its own map; local: (n, 12) as those of `maps`."""
    found = points.copy()
    for i in range(len(points)):
        for b in range(3):
            found[i, b] += local[i, 9 + b]
            for a in range(3):
                found[i, b] += points[i, a] * local[i, 3 * a + b]
    return found


@compiled
def spread_out(points: Floats, count: int) -> Ints:
    """Indices of up to `count` of (n, 3) points, each the farthest from those before."""
    chosen, away = [0], np.full(len(points), np.inf)
    while True:
        x, y, z = points[chosen[-1], 0], points[chosen[-1], 1], points[chosen[-1], 2]
        farthest = 0
        for i in range(len(points)):
            u, v, w = points[i, 0] - x, points[i, 1] - y, points[i, 2] - z
            away[i] = min(away[i], u * u + v * v + w * w)
            if away[i] > away[farthest]:
                farthest = i
        if len(chosen) == min(count, len(points)) or away[farthest] == 0:
            return np.array(chosen)
        chosen.append(farthest)
