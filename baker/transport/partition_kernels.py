"""Compiled: recursive bisection of a cloud down to its points, and the north-west corner rule."""

import numpy as np
from numpy.typing import NDArray

from baker.transport.compiled import compiled
from baker.transport.problem import Coupling, Masses

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
def north_west_corner(supply: Masses, demand: Masses, plan: Coupling, following: Ints) -> Coupling:
    """Distribute the mass of each pair of blocks to pairs of their points, in their order.

    supply, demand: (n,) and (m,) masses of the points, block after block. plan: (3, E) rows,
    columns and masses of pairs of blocks, sorted by row, then column, like the plan returned.
    following: the first column of each block; it becomes the next one to receive mass.
    """
    refined = np.empty((3, plan.shape[1] + len(supply) + len(demand)), np.int64)
    found, row, given, left = 0, 0, supply[0], demand.copy()
    for pair in range(plan.shape[1]):
        column, rest = following[plan[1, pair]], plan[2, pair]
        while rest > 0:
            while given == 0:
                row += 1
                given = supply[row]
            while left[column] == 0:
                column += 1
            moved = min(rest, given, left[column])
            refined[0, found], refined[1, found], refined[2, found] = row, column, moved
            found, rest, given = found + 1, rest - moved, given - moved
            left[column] -= moved
        following[plan[1, pair]] = column
    return refined[:, :found].copy()
