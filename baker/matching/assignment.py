"""Matching two sets of alternatives, each of which may stay alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.matching.lazy import LazyCosts


def assign_with_dummies(
    costs: NDArray[np.floating], loss: NDArray[np.floating], birth: NDArray[np.floating]
) -> list[tuple[int, int]]:
    """Cheapest matching of n rows and m columns in which any of them may stay alone.

    costs: (n, m); loss: (n,) price of leaving a row alone; birth: (m,) of a column.
    """
    from scipy.optimize import linear_sum_assignment

    n, m = costs.shape
    never = 1.0 + 2.0 * float(costs.sum() + loss.sum() + birth.sum())
    square = np.zeros((n + m, n + m))
    square[:n, :m] = costs
    square[:n, m:] = np.where(np.eye(n, dtype=bool), loss[:, None], never)
    square[n:, :m] = np.where(np.eye(m, dtype=bool), birth[None, :], never)
    rows, columns = linear_sum_assignment(square)
    return [(int(i), int(j)) for i, j in zip(rows, columns, strict=True) if i < n and j < m]


def assign_by_minima(costs: LazyCosts) -> list[tuple[int, int]]:
    """The paper's way: leave out as many as there are too many, the farthest first, match the rest.

    costs: (n, m); of the larger side the |n - m| whose nearest partner is farthest stay alone.
    """
    n, m = costs.shape
    rows, columns = np.arange(n), np.arange(m)
    if n > m:
        rows = np.sort(np.argsort(costs.minima(axis=1), kind="stable")[:m])
    elif m > n:
        columns = np.sort(np.argsort(costs.minima(axis=0), kind="stable")[:n])
    return costs.assignment(rows, columns)
