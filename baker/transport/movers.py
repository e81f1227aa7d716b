"""From a transport plan to the few pairs that are animated (paper, end of section 3.4)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.transport.plan import Indices, Plan


def movers(
    plan: Plan, n: int, m: int
) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float32]]:
    """The non-zero entries of T-hat = (T' + T'') / 2: the maxima of T's rows and of its columns.

    Returns rows, columns (M,) int32 and weights (M,) float32, 1 where a pair is the maximum of its
    row and of its column, 1/2 where of one; ordered by row, then column; M <= n + m, and every
    point of either side is in at least one. Ties go to the lowest index. Raises ValueError where
    the plan leaves out a point.
    """
    chosen = [
        _maxima(plan.rows, plan.columns, plan.mass),
        _maxima(plan.columns, plan.rows, plan.mass),
    ]
    for name, entries, count in zip(("start", "end"), chosen, (n, m), strict=True):
        if len(entries) != count:
            raise ValueError(f"the plan uses {len(entries)} of the {count} points of the {name}")
    picked = np.zeros(len(plan.mass), np.float32)
    for entries in chosen:
        picked[entries] += 0.5
    used = np.flatnonzero(picked)
    used = used[np.lexsort((plan.columns[used], plan.rows[used]))]
    return plan.rows[used], plan.columns[used], picked[used]


def _maxima(group: Indices, other: Indices, mass: NDArray[np.float64]) -> NDArray[np.int64]:
    """The entry of the largest mass in each group, on ties the one of the lowest `other`."""
    order = np.lexsort((other, -mass, group))
    return order[np.diff(group[order], prepend=-1) != 0]
