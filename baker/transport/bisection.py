"""Compiled recursive bisection of a cloud down to single points, and plans between its blocks."""

import numpy as np
from numpy.typing import NDArray

from baker.transport.compiled import compiled

Ints = NDArray[np.integer]
Floats = NDArray[np.float64]


@compiled
def bisect(points: Floats, order: Ints, axes: Ints, has_axes: bool) -> None:
    """Sort the `order` of (3, n) points in place, level by level, part by part.

    Part p of a level of `parts` parts is bisected along ``axes[parts + p]``; unless `has_axes`,
    along its longest extent, which is written to `axes`. Equivalent, for each part, to
    ``order[begin:stop] = order[begin:stop][np.argsort(points[axis, order[begin:stop]])]``.
    """
    n, parts = len(order), 1
    while parts < n:
        for part in range(parts):
            begin, stop = (part * n + parts - 1) // parts, ((part + 1) * n + parts - 1) // parts
            if stop - begin > 1:
                if not has_axes:
                    axes[parts + part] = _longest_extent(points, order[begin:stop])
                middle = ((2 * part + 1) * n + 2 * parts - 1) // (2 * parts)
                _select(points[axes[parts + part]], order, begin, stop, middle)
        parts *= 2


@compiled
def _longest_extent(points: Floats, part: Ints) -> int:
    """Equivalent to ``np.ptp(points[:, part], axis=1).argmax()``."""
    longest, extent = 0, -1.0
    for axis in range(3):
        low = high = points[axis, part[0]]
        for point in part:
            low, high = min(low, points[axis, point]), max(high, points[axis, point])
        if high - low > extent:
            longest, extent = axis, high - low
    return longest


@compiled
def _select(values: Floats, order: Ints, begin: int, stop: int, middle: int) -> None:
    """Move the smaller values of a part before its middle, the others after it (quickselect).

    Equivalent to ``np.argpartition(values[order[begin:stop]], middle - begin)`` on that part.
    """
    while stop - begin > 1:
        pivot, low, high = values[order[(begin + stop) // 2]], begin, stop - 1
        while low <= high:
            while values[order[low]] < pivot:
                low += 1
            while values[order[high]] > pivot:
                high -= 1
            if low <= high:
                order[low], order[high] = order[high], order[low]
                low, high = low + 1, high - 1
        if middle <= high:
            stop = high + 1
        elif middle >= low:
            begin = low
        else:
            return


@compiled
def north_west_corner(
    supply: Ints, demand: Ints, block: Ints, mass: Ints
) -> tuple[Ints, Ints, NDArray[np.int64]]:
    """Distribute the mass of pairs of blocks among their rows and columns, one after the other.

    supply, demand: masses of the rows and columns, which are in the order of their blocks. block,
    mass: (E,) the block of columns and the mass of each pair, sorted by the block of rows. Returns
    the rows, columns and masses of the pairs of points.
    """
    block_mass = np.zeros(block.max() + 1, np.int64)
    for pair in range(len(mass)):
        block_mass[block[pair]] += mass[pair]
    # The column of each block that is being filled, before the first one, and what it still lacks.
    column, lacking, first = np.zeros_like(block_mass), np.zeros_like(block_mass), 0
    for k in range(len(column)):
        column[k] = first - 1
        while block_mass[k] > 0:
            block_mass[k] -= demand[first]
            first += 1
    size = len(mass) + len(supply) + len(demand)
    rows, columns, flow = np.empty((3, size), np.int64)
    found, row, offered = 0, -1, 0
    for pair in range(len(mass)):
        left, k = mass[pair], block[pair]
        while left > 0:
            while offered == 0:
                row += 1
                offered = supply[row]
            while lacking[k] == 0:
                column[k] += 1
                lacking[k] = demand[column[k]]
            moved = min(left, offered, lacking[k])
            rows[found], columns[found], flow[found] = row, column[k], moved
            left, offered, lacking[k] = left - moved, offered - moved, lacking[k] - moved
            found += 1
    return rows[:found], columns[:found], flow[:found]
