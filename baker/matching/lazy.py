"""Deciding by the least of many distances while working out few of them.

Each distance is known to be at least some bound. What can't win by its bound is left alone, so the
outcome is, bit for bit, the one of working out all.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

TIE = 1e-9  # share of the largest cost by which two assignments must differ to be told apart


def least(
    bounds: NDArray[np.floating], distance: Callable[[int], float], limit: float
) -> tuple[float, int] | None:
    """The least distance and its index, the lowest of those tied; None where none is below `limit`.

    bounds:   what each distance is at least.
    distance: works out one, by its index.
    """
    best: tuple[float, int] | None = None
    for index in np.argsort(bounds, kind="stable").tolist():
        if bounds[index] >= limit or (best is not None and bounds[index] > best[0]):
            break
        found = (distance(index), index)
        best = found if best is None else min(best, found)
    return best if best is not None and best[0] < limit else None


class LazyCosts:
    """An (n, m) matrix of costs of which each entry is worked out when it is first needed.

    bounds: (n, m) what the costs are at least; cost: works out one, by row and column.
    """

    def __init__(self, bounds: NDArray[np.floating], cost: Callable[[int, int], float]) -> None:
        self.shape = bounds.shape
        self._values = np.array(bounds, np.float64)
        self._known = np.zeros(bounds.shape, bool)
        self._cost = cost

    def minima(self, axis: int) -> NDArray[np.float64]:
        """The least cost of each row (axis 1) or column (axis 0)."""
        lines = [[(i, j) for j in range(self.shape[1])] for i in range(self.shape[0])]
        if axis == 0:
            lines = [list(line) for line in zip(*lines, strict=True)]
        return np.array([self._minimum(line) for line in lines])

    def all(self) -> NDArray[np.float64]:
        """Every cost."""
        self._work_out(np.argwhere(~self._known))
        return self._values.copy()

    def assignment(
        self, rows: NDArray[np.integer], columns: NDArray[np.integer]
    ) -> list[tuple[int, int]]:
        """The cheapest one-to-one assignment of these rows to as many columns.

        An assignment that is optimal by the bounds, and whose own costs are known, is optimal by
        all costs. Where another one is as good, all costs decide.
        """
        from scipy.optimize import linear_sum_assignment

        while True:
            costs = self._values[np.ix_(rows, columns)]
            _, partner = linear_sum_assignment(costs)
            needed = np.column_stack([rows, columns[partner]])
            if not self._work_out(needed):
                tied = _in_other_optima(costs, partner)
                if not len(tied):
                    return [(int(i), int(j)) for i, j in needed]
                if not self._work_out(np.column_stack([rows[tied[:, 0]], columns[tied[:, 1]]])):
                    _, partner = linear_sum_assignment(self.all()[np.ix_(rows, columns)])
                    return [(int(i), int(columns[j])) for i, j in zip(rows, partner, strict=True)]

    def _minimum(self, line: list[tuple[int, int]]) -> float:
        values = [self._values[place] for place in line]
        best = np.inf
        for k in np.argsort(values, kind="stable").tolist():
            if values[k] > best:
                break
            self._work_out(np.array([line[k]]))
            best = min(best, float(self._values[line[k]]))
        return best

    def _work_out(self, places: NDArray[np.integer]) -> bool:
        """Work out the costs at (k, 2) places; False where all were known."""
        is_new = False
        for i, j in places.tolist():
            if not self._known[i, j]:
                self._values[i, j] = self._cost(i, j)
                self._known[i, j] = is_new = True
        return is_new


def _in_other_optima(
    costs: NDArray[np.float64], partner: NDArray[np.integer]
) -> NDArray[np.integer]:
    """(k, 2) places of square `costs` that are in another assignment as cheap as `partner`, if any.

    An assignment is changed along a cycle: each row on it takes the next one's column. The cycles
    that cost nothing lie in the strong components of the steps that cost nothing, as seen from
    potentials that no step undercuts (shortest paths, Bellman-Ford).
    """
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import connected_components

    own = costs[np.arange(len(costs)), partner]
    step = costs[:, partner] - own
    potential = np.zeros(len(costs))
    for _ in range(len(costs)):
        shorter = (potential[:, None] + step).min(axis=0)
        if (shorter >= potential).all():
            break
        potential = np.minimum(potential, shorter)
    free = step + potential[:, None] - potential <= TIE * np.abs(costs).max(initial=0.0)
    np.fill_diagonal(free, False)
    _, component = connected_components(csr_matrix(free), directed=True, connection="strong")
    rows, others = np.nonzero(free & (component[:, None] == component))
    return np.column_stack([rows, partner[others]])
