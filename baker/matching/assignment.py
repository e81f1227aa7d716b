"""One-to-one assignment of two sets of segments in which segments may stay unmatched."""

import numpy as np
from numpy.typing import NDArray


def assign_with_dummies(
    costs: NDArray[np.floating], loss: NDArray[np.floating], birth: NDArray[np.floating]
) -> list[tuple[int, int]]:
    """Assign rows to columns at the least total cost, with a dummy partner for each of them.

    costs: (n, m) of matching a row to a column; loss, birth: (n,) and (m,) of leaving a row or a
    column unmatched. Returns the matched pairs, by row.
    """
    from scipy.optimize import linear_sum_assignment

    n, m = costs.shape
    forbidden = 1.0 + 2.0 * float(costs.sum() + loss.sum() + birth.sum())
    lost, born = (np.where(np.eye(len(c), dtype=bool), c, forbidden) for c in (loss, birth))
    padded = np.block([[costs, lost], [born, np.zeros((m, n))]])
    rows, columns = linear_sum_assignment(padded)
    return [(int(i), int(j)) for i, j in zip(rows, columns, strict=True) if i < n and j < m]


def assign_by_minima(costs: NDArray[np.floating]) -> list[tuple[int, int]]:
    """Assign as the paper does: the surplus of the larger side is left out first (section 3.3.1).

    Of the larger side, the ``|n - m|`` segments whose nearest partner is farthest stay unmatched.
    Returns ``min(n, m)`` pairs, by row.
    """
    from scipy.optimize import linear_sum_assignment

    n, m = costs.shape
    rows, columns = np.arange(n), np.arange(m)
    if n > m:
        rows = np.sort(np.argsort(costs.min(axis=1), kind="stable")[:m])
    elif m > n:
        columns = np.sort(np.argsort(costs.min(axis=0), kind="stable")[:n])
    i, j = linear_sum_assignment(costs[np.ix_(rows, columns)])
    return list(zip(rows[i].tolist(), columns[j].tolist(), strict=True))
