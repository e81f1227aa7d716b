"""Morton codes of small clouds, one organ after the other; compiled: import this module late."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.compiled import compiled


@compiled
def morton_codes(points: NDArray[np.floating]) -> NDArray[np.uint64]:
    """(N,) as those of `gclip.pack`, in a tenth of the time where there are few points."""
    count = len(points)
    codes, low, size = np.zeros(count, np.uint64), np.zeros(3), 0.0
    for axis in range(3):
        least, most = np.inf, -np.inf
        for i in range(count):
            least, most = min(least, points[i, axis]), max(most, points[i, axis])
        low[axis], size = least, max(size, most - least)
    steps = (2**21 - 1) / size if size > 0.0 else 0.0
    for i in range(count):
        for axis in range(3):
            cell = np.uint64((points[i, axis] - low[axis]) * steps)
            cell = (cell | (cell << np.uint64(32))) & np.uint64(0x1F00000000FFFF)
            cell = (cell | (cell << np.uint64(16))) & np.uint64(0x1F0000FF0000FF)
            cell = (cell | (cell << np.uint64(8))) & np.uint64(0x100F00F00F00F00F)
            cell = (cell | (cell << np.uint64(4))) & np.uint64(0x10C30C30C30C30C3)
            cell = (cell | (cell << np.uint64(2))) & np.uint64(0x1249249249249249)
            codes[i] |= cell << np.uint64(axis)
    return codes
