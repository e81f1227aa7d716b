"""The closest pair of two small moving clouds, compiled by numba: import this module late."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.compiled import compiled

BLOCK = 16  # points that are passed over together where their ball is too far off


@compiled
def closest(
    mine: NDArray[np.floating], theirs: NDArray[np.floating]
) -> tuple[NDArray[np.floating], NDArray[np.integer], NDArray[np.integer]]:
    """(I,) distances and indices of the pair nearest to each other at each of I instants.

    mine, theirs: (I, a, 3) and (I, b, 3).

    All pairs count; it is fast where neighbours in `theirs` lie side by side.
    """
    instants, count = len(mine), theirs.shape[1]
    blocks = -(-count // BLOCK)
    gap = np.empty(instants)
    first, second = np.zeros(instants, np.int64), np.zeros(instants, np.int64)
    centre, radius = np.empty((blocks, 3)), np.empty(blocks)
    for k in range(instants):
        for block in range(blocks):
            members = theirs[k, block * BLOCK : (block + 1) * BLOCK]
            for axis in range(3):
                centre[block, axis] = members[:, axis].mean()
            widest = 0.0
            for j in range(len(members)):
                widest = max(widest, _squared(members[j], centre[block]))
            radius[block] = np.sqrt(widest)
        least, reach = np.inf, np.inf
        for i in range(mine.shape[1]):
            for block in range(blocks):
                beyond = reach + radius[block]
                if _squared(mine[k, i], centre[block]) > beyond * beyond:
                    continue
                for j in range(block * BLOCK, min((block + 1) * BLOCK, count)):
                    squared = _squared(mine[k, i], theirs[k, j])
                    if squared < least:
                        least, first[k], second[k] = squared, i, j
                        reach = np.sqrt(squared)
        gap[k] = reach
    return gap, first, second


@compiled
def _squared(a: NDArray[np.floating], b: NDArray[np.floating]) -> float:
    x, y, z = a[0] - b[0], a[1] - b[1], a[2] - b[2]
    return x * x + y * y + z * z
