"""The loop of recursive bisection, compiled by numba: import this module late."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.compiled import compiled


@compiled
def halve(
    points: NDArray[np.floating], depth: int, axes: NDArray[np.integer], axes_known: bool
) -> NDArray[np.integer]:
    """(n,) indices of (n, 3) points, sorted within each half of each half ... `depth` times.

    On every level, part p of 2 ** level parts goes from p n / 2 ** level on, rounded up, and is
    sorted along one axis, equal ones as they stand: along axes[2 ** level + p], or, where those
    are not known, along the longest extent, which is put there.
    """
    n = len(points)
    order = np.arange(n)
    for level in range(depth):
        parts = 1 << level
        for part in range(parts):
            begin, end = -(-part * n // parts), -(-(part + 1) * n // parts)
            members = order[begin:end].copy()
            if not axes_known:
                axes[parts + part] = _longest(points, members)
            along = np.empty(len(members))
            for i in range(len(members)):
                along[i] = points[members[i], axes[parts + part]]
            order[begin:end] = members[np.argsort(along, kind="mergesort")]
    return order


@compiled
def _longest(points: NDArray[np.floating], members: NDArray[np.integer]) -> int:
    """The axis along which the members extend furthest."""
    longest, chosen = -1.0, 0
    for axis in range(3):
        low, high = np.inf, -np.inf
        for i in members:
            low, high = min(low, points[i, axis]), max(high, points[i, axis])
        if high - low > longest:
            longest, chosen = high - low, axis
    return chosen
