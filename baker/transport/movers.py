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
    order = np.argsort(plan.rows.astype(np.int64) * m + plan.columns, kind="stable")
    rows, columns, mass = plan.rows[order], plan.columns[order], plan.mass[order]
    picked = np.zeros(len(mass), np.float32)
    for name, side, count in (("start", rows, n), ("end", columns, m)):
        entries = _maxima(side, mass)
        if len(entries) != count:
            raise ValueError(f"the plan uses {len(entries)} of the {count} points of the {name}")
        picked[entries] += 0.5
    used = np.flatnonzero(picked)
    return rows[used], columns[used], picked[used]


def _maxima(group: Indices, mass: NDArray[np.float64]) -> NDArray[np.intp]:
    """The entry of the largest mass in each group, on ties the first one."""
    order = np.argsort(group, kind="stable")
    ordered, first = mass[order], np.flatnonzero(np.diff(group[order], prepend=-1))
    largest = np.maximum.reduceat(ordered, first)
    found = order[ordered == np.repeat(largest, np.diff(first, append=len(order)))]
    return found[np.diff(group[found], prepend=-1) != 0]
