"""Where a labelled cloud's segments may meet: a quick choice of points before a search."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from gclip.pack import extent


def near_others(
    points: NDArray[np.floating], owner: NDArray[np.intp], threshold: float
) -> NDArray[np.bool_]:
    """(N,) whether a point may be nearer than the threshold to another segment; most are not.

    A point is not where the 27 cubes about it, each as long as the threshold, hold one segment.
    """
    if threshold == 0:
        return np.ones(len(points), bool)
    low, high = extent(points)
    if np.prod((high - low).astype(float) / threshold + 4) > 2.0**62:
        return np.ones(len(points), bool)
    near = _near_borders(points, owner, low, high, threshold)
    some = np.flatnonzero(near)
    if len(some):
        places = np.floor((points[some] - low) / (1.001 * threshold)) + 1
        near[some] = _among_others(places.astype(np.int64), owner[some])
    return near


def _near_borders(
    points: NDArray[np.floating],
    owner: NDArray[np.intp],
    low: NDArray[np.floating],
    high: NDArray[np.floating],
    threshold: float,
) -> NDArray[np.bool_]:
    """The same of cubes at least twice as long, and so long that they are no more than points.

    So few can all be looked at, empty ones as well, without any sorting.
    """
    size = 2.002 * threshold
    while np.prod((high - low).astype(float) / size + 3) > max(len(points), 64):
        size *= 1.2
    cells = ((points - low) / size).astype(np.int64) + 1
    shape = extent(cells)[1] + 2
    keys = (cells[:, 0] * shape[1] + cells[:, 1]) * shape[2] + cells[:, 2]
    most = np.full(np.prod(shape), -1)
    most[keys] = owner  # any of the cube's
    least = np.where(most < 0, len(owner), most)
    mixed = keys[most[keys] != owner]
    most[mixed], least[mixed] = len(owner), -1
    meet = _of_27(most.reshape(shape), np.maximum) > _of_27(least.reshape(shape), np.minimum)
    return meet.ravel()[keys]


def _of_27(grid: NDArray[np.integer], most: np.ufunc) -> NDArray[np.integer]:
    """The most, or the least, of each cube and those around it; the outermost ones are empty."""
    for axis in range(3):
        along = np.moveaxis(grid, axis, 0)
        grid = grid.copy()
        inner = np.moveaxis(grid, axis, 0)[1:-1]
        most(most(along[:-2], along[1:-1]), along[2:], out=inner)
    return grid


def _among_others(cells: NDArray[np.int64], owner: NDArray[np.intp]) -> NDArray[np.bool_]:
    """(N,) whether the 27 cubes about each point's cell, (N, 3), hold more than one segment."""
    size = extent(cells)[1] + 2
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
    cube = np.empty(len(cells), np.intp)
    cube[order] = np.cumsum(is_first) - 1
    return (lowest < highest)[cube]
