"""From a transport plan to the few pairs that are animated (paper, end of section 3.4)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.transport.problem import Indices, Plan


def movers(
    plan: Plan, n: int, m: int
) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float32]]:
    """The non-zero entries of T-hat = (T' + T'') / 2: the maxima of T's rows and of its columns.

    Returns rows, columns (M,) int32 and weights (M,) float32, 1 where a pair is the maximum of its
    row and of its column, 1/2 where of one; ordered by row, then column; M <= n + m, and every
    point of either side is in at least one. Ties go to the lowest index. Raises ValueError where
    the plan leaves out a point.
    """
    rows, columns, mass = plan.rows, plan.columns, plan.mass
    picked = np.zeros(len(mass), np.float32)
    for name, side, count in (("start", rows, n), ("end", columns, m)):
        entries = _maxima(side, mass, count)
        if (entries < 0).any():
            used = int((entries >= 0).sum())
            raise ValueError(f"the plan uses {used} of the {count} points of the {name}")
        picked[entries] += 0.5
    moved = np.flatnonzero(picked)
    return rows[moved], columns[moved], picked[moved]


def _maxima(group: Indices, mass: NDArray[np.float64], count: int) -> NDArray[np.intp]:
    """(count,) the entry of the largest mass in each group, on ties the first one; -1 for none."""
    largest, entries = np.zeros(count), np.full(count, -1)
    np.maximum.at(largest, group, mass)
    backwards = np.flatnonzero(mass == largest[group])[::-1]
    entries[group[backwards]] = backwards  # of those of a group the last to be written stays
    return entries
