"""The loops of recursive bisection, compiled by numba: import this module late."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.geometry.compiled import compiled


@compiled
def halve(
    points: NDArray[np.floating], depth: int, axes: NDArray[np.integer], axes_known: bool
) -> NDArray[np.intp]:
    """(n,) indices of (n, 3) points, halved `depth` times, and on the last level sorted.

    On every level, part p of 2 ** level parts goes from p n / 2 ** level on, rounded up, and is
    parted along one axis: along axes[2 ** level + p], or, where those are not known, along the
    longest extent, which is put there.
    """
    n = len(points)
    order = np.arange(n)
    # What has been parted last is parted on: its points are still in the cache.
    waiting, left = np.ones(depth + 1, np.int64), min(depth, 1)
    while left > 0:
        left -= 1
        branch = waiting[left]
        level = 0
        while branch >> level > 1:
            level += 1
        parts, part = 1 << level, branch - (1 << level)
        begin, end = -(-part * n // parts), -(-(part + 1) * n // parts)
        members = order[begin:end].copy()
        if not axes_known:
            axes[branch] = _longest(points, members)
        along = np.empty(len(members))
        for i in range(len(members)):
            along[i] = points[members[i], axes[branch]]
        if level + 1 == depth:
            order[begin:end] = members[np.argsort(along, kind="mergesort")]
            continue
        # Only which half they are in counts: the next level orders them anew.
        _select(along, members, -(-(2 * part + 1) * n // (2 * parts)) - begin)
        order[begin:end] = members
        waiting[left], waiting[left + 1] = 2 * branch + 1, 2 * branch
        left += 2
    return order


@compiled
def _select(values: NDArray[np.floating], members: NDArray[np.integer], middle: int) -> None:
    """Order both so that no value before the middle is larger than one from there on.

    Quickselect (Hoare, Comm. ACM 4, 1961).
    """
    first, last = 0, len(values) - 1
    while first < last:
        a, b, c = values[first], values[(first + last) // 2], values[last]
        pivot = max(min(a, b), min(max(a, b), c))
        i, j = first, last
        while i <= j:
            while values[i] < pivot:
                i += 1
            while values[j] > pivot:
                j -= 1
            if i <= j:
                values[i], values[j] = values[j], values[i]
                members[i], members[j] = members[j], members[i]
                i, j = i + 1, j - 1
        if middle <= j:
            last = j
        elif middle >= i:
            first = i
        else:
            return


@compiled
def _longest(points: NDArray[np.floating], members: NDArray[np.integer]) -> int:
    """The axis along which the members extend furthest."""
    longest, chosen = -1.0, 0
    for axis in range(3):
        low, high = np.inf, -np.inf
        for i in members:
            low, high = min(low, points[i, axis]), max(high, points[i, axis])
        if high - low > longest:
            longest, chosen = high - low, axis
    return chosen


@compiled
def hand_out(
    columns: NDArray[np.integer],
    mass: NDArray[np.integer],
    supply: NDArray[np.integer],
    demand: NDArray[np.integer],
    first: NDArray[np.integer],
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Pairs of points, by row, then column, and their masses, out of those of pairs of blocks.

    columns, mass: of pairs of blocks, by row, then column: together all mass of either side.
    supply, demand: of the points, block after block; first: where each block of columns begins.
    """
    most = len(mass) + len(supply) + len(demand)
    one, other = np.empty(most, np.int64), np.empty(most, np.int64)
    handed, made = np.empty(most, np.int64), 0
    place, row = first.copy(), 0
    left, wanted = supply[0], demand[first]
    for pair in range(len(mass)):
        block, rest = columns[pair], mass[pair]
        while rest > 0:
            while left == 0:
                row += 1
                left = supply[row]
            while wanted[block] == 0:
                place[block] += 1
                wanted[block] = demand[place[block]]
            part = min(rest, left, wanted[block])
            one[made], other[made], handed[made] = row, place[block], part
            rest, left, made = rest - part, left - part, made + 1
            wanted[block] -= part
    return one[:made], other[:made], handed[:made]
