"""Where a labelled cloud's segments may meet: a quick choice of points before a search."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray


def near_others(
    points: NDArray[np.floating], owner: NDArray[np.intp], threshold: float
) -> NDArray[np.bool_]:
    """(N,) whether a point may be nearer than the threshold to another segment; most are not.

    A point is not where the 27 cubes about it, each as long as the threshold, hold one segment.
    """
    if threshold == 0:
        return np.ones(len(points), bool)
    places = np.floor((points - points.min(axis=0)) / (1.001 * threshold)) + 1
    if np.prod(places.max(axis=0).astype(float) + 2) > 2.0**62:
        return np.ones(len(points), bool)
    cells = places.astype(np.int64)
    size = cells.max(axis=0) + 2
    keys = (cells[:, 0] * size[1] + cells[:, 1]) * size[2] + cells[:, 2]
    order = np.argsort(keys, kind="stable")
    occupied, first = np.unique(keys[order], return_index=True)
    least = np.minimum.reduceat(owner[order], first)
    most = np.maximum.reduceat(owner[order], first)
    lowest, highest = least.copy(), most.copy()
    for x, y, z in product((-1, 0, 1), repeat=3):
        beside = occupied + (x * size[1] + y) * size[2] + z
        place = np.minimum(np.searchsorted(occupied, beside), len(occupied) - 1)
        there = occupied[place] == beside
        np.minimum(lowest, np.where(there, least[place], lowest), out=lowest)
        np.maximum(highest, np.where(there, most[place], highest), out=highest)
    return (lowest < highest)[np.searchsorted(occupied, keys)]
