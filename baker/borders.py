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
    ordered = keys[order]
    is_first = np.diff(ordered, prepend=ordered[0] - 1) > 0
    first = np.flatnonzero(is_first)
    occupied = ordered[first]
    least = np.minimum.reduceat(owner[order], first)
    most = np.maximum.reduceat(owner[order], first)
    lowest, highest = least.copy(), most.copy()
    for x, y in product((-1, 0, 1), repeat=2):
        middle = occupied + (x * size[1] + y) * size[2]
        place = np.searchsorted(occupied, middle - 1)
        for _ in range(3):  # the cubes of a column follow one another
            there = np.minimum(place, len(occupied) - 1)
            beside = np.abs(occupied[there] - middle) <= 1
            np.minimum(lowest, np.where(beside, least[there], lowest), out=lowest)
            np.maximum(highest, np.where(beside, most[there], highest), out=highest)
            place += 1
    cube = np.empty(len(points), np.intp)
    cube[order] = np.cumsum(is_first) - 1
    return (lowest < highest)[cube]
