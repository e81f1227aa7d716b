"""The loops of `baker.transport.space_partition`.

Compiled by numba: import this module late.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.transport.compiled import compiled

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


@compiled
def bisect(points: Floats, axes: Ints, axes_known: bool, depth: int) -> Ints:
    """Order a cloud by halving it, and its halves, and so on.

    Parameters
    ----------
    points : (n, 3) float64 ndarray
    axes : (2 ** depth,) int64 ndarray
        The axis that each part is cut along. Part p of a level of 2 ** level parts is
        ``axes[2 ** level + p]``, and has the points from p n / 2 ** level on, rounded up.
    axes_known : bool
        Cut along these axes; else along each part's longest extent, which is put there.
    depth : int
        Number of levels.

    Returns
    -------
    (n,) int64 ndarray
        Indices of the points.
    """
    n = len(points)
    order = np.arange(n)
    # Depth first: the points of the part that was just cut are still in the cache.
    stack, height = np.ones(depth + 1, np.int64), min(depth, 1)
    while height > 0:
        height -= 1
        branch = stack[height]
        level = 0
        while branch >> level > 1:
            level += 1
        parts, part = 1 << level, branch - (1 << level)
        begin, end = -(-part * n // parts), -(-(part + 1) * n // parts)
        members = order[begin:end]
        if not axes_known:
            longest = -1.0
            for axis in range(3):
                low, high = np.inf, -np.inf
                for i in members:
                    low, high = min(low, points[i, axis]), max(high, points[i, axis])
                if high - low > longest:
                    longest, axes[branch] = high - low, axis
        axis = axes[branch]
        values = np.empty(len(members))
        for i in range(len(members)):
            values[i] = points[members[i], axis]
        _select(values, members, -(-(2 * part + 1) * n // (2 * parts)) - begin)
        if level + 1 < depth:
            stack[height], stack[height + 1] = 2 * branch + 1, 2 * branch
            height += 2
    return order


@compiled
def _select(values: Floats, members: Ints, middle: int) -> None:
    """Order both so that no value before the middle is larger than one from there on.

    Quickselect (Hoare, Comm. ACM 4, 1961). Equivalent to
    ``order = np.argpartition(values, middle); members[:] = members[order]``.
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
def refine(
    columns: Ints, mass: Ints, supply: Ints, demand: Ints, first: Ints
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """A plan between points from a plan between blocks, by the north-west corner rule.

    Parameters
    ----------
    columns, mass : (E,) int64 ndarray
        Pairs of blocks by row, then column: together all mass of either side.
    supply, demand : (n,) and (m,) int64 ndarray
        Masses of the points, block after block.
    first : (blocks,) int64 ndarray
        Where each block of columns begins.

    Returns
    -------
    rows, columns, mass : (F,) int64 ndarray
        Pairs of points, by row, then column; F < E + n + m.
    """
    room = len(mass) + len(supply) + len(demand)
    pairs, count = np.empty((3, room), np.int64), 0
    place, row = first.copy(), 0
    left, wanted = supply[0], demand[first]
    for edge in range(len(mass)):
        block, rest = columns[edge], mass[edge]
        while rest > 0:
            while left == 0:
                row += 1
                left = supply[row]
            while wanted[block] == 0:
                place[block] += 1
                wanted[block] = demand[place[block]]
            part = min(rest, left, wanted[block])
            pairs[0, count], pairs[1, count], pairs[2, count] = row, place[block], part
            rest, left, count = rest - part, left - part, count + 1
            wanted[block] -= part
    return pairs[0, :count], pairs[1, :count], pairs[2, :count]
