"""Labels by their numbers: looked up, not sorted, where they are not far apart."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def numbered(labels: NDArray[np.integer]) -> tuple[NDArray[np.integer], NDArray[np.intp]]:
    """The (K,) distinct ones of (N,) labels, ascending, and which of them each is."""
    if labels.dtype.kind not in "iu" or not len(labels):
        return np.unique(labels, return_inverse=True)
    low, high = labels.min(), labels.max()
    if int(high) - int(low) >= len(labels):
        return np.unique(labels, return_inverse=True)
    wide = labels.astype(np.int64 if labels.dtype.kind == "i" else np.uint64)
    place = (wide - wide.dtype.type(low)).astype(np.intp)
    there = np.zeros(int(high) - int(low) + 1, bool)
    there[place] = True
    names = (np.flatnonzero(there) + low).astype(labels.dtype)
    return names, (np.cumsum(there) - 1).take(place)
