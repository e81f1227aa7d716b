"""Compiled: recursive bisection of a cloud down to its points."""

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
