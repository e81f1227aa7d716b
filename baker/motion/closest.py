"""The closest pair of two small moving clouds, compiled by numba: import this module late."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.compiled import compiled


@compiled
def closest(
    mine: NDArray[np.floating], theirs: NDArray[np.floating]
) -> tuple[NDArray[np.floating], NDArray[np.integer], NDArray[np.integer]]:
    """(I,) distances and indices of the pair nearest to each other at each of I instants.

    mine, theirs: (I, a, 3) and (I, b, 3). All pairs are tried; ties go to the lowest indices.
    """
    instants = len(mine)
    gap = np.full(instants, np.inf)
    first, second = np.zeros(instants, np.int64), np.zeros(instants, np.int64)
    for k in range(instants):
        for i in range(mine.shape[1]):
            for j in range(theirs.shape[1]):
                x = mine[k, i, 0] - theirs[k, j, 0]
                y = mine[k, i, 1] - theirs[k, j, 1]
                z = mine[k, i, 2] - theirs[k, j, 2]
                squared = x * x + y * y + z * z
                if squared < gap[k]:
                    gap[k], first[k], second[k] = squared, i, j
    return np.sqrt(gap), first, second
