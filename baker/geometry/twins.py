"""Movers that have an end in common; compiled by numba: import this module late."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.geometry.compiled import compiled


@compiled
def mean_of_twins(
    ends: NDArray[np.intp], order: NDArray[np.intp], values: NDArray[np.floating]
) -> NDArray[np.float64]:
    """(N, 3) each mover's mean of (N, 3) values over all that have the same end.

    order: that sorts the ends.
    """
    means = np.empty(values.shape)
    begin = 0
    while begin < len(order):
        end = begin
        x, y, z = 0.0, 0.0, 0.0
        while end < len(order) and ends[order[end]] == ends[order[begin]]:
            i = order[end]
            x, y, z = x + values[i, 0], y + values[i, 1], z + values[i, 2]
            end += 1
        count = end - begin
        x, y, z = x / count, y / count, z / count
        for k in range(begin, end):
            i = order[k]
            means[i, 0], means[i, 1], means[i, 2] = x, y, z
        begin = end
    return means
