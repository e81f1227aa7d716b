"""Choose the pairs of points that may carry mass: the support of the plan.

With the k = 15 nearest neighbours of the paper, usually not all of the mass can be transported.
Two things make few neighbours sufficient: to search for them after a linear map has been factored
out (`balance`), and to start from a plan that is feasible by construction (`bisection_plan`).
"""

import numpy as np
from numpy.typing import NDArray

from baker.transport.problem import Edges, Points

TINY = float(np.finfo(float).tiny)
RIDGE = 1e-4  # share of the mean variance added to each axis, so that covariances are invertible


def balance(start: Points, end: Points) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Center both clouds and map them linearly so that their covariances agree.

    The optimal plan does not change: it maximises the sum of <p, q>, and <p, q> = <A p, A^-T q> for
    every invertible A. Let S be the optimal map between Gaussians with the moments of the clouds,
    S Cov(p) S = Cov(q). Then A = S^1/2 removes translation, growth and stretching from the cost.

    References
    ----------
    M. Gelbrich: On a formula for the L2 Wasserstein metric between measures on Euclidean and
    Hilbert spaces, Math. Nachr. 147 (1990).
    """
    p = np.asarray(start, np.float64) - np.mean(start, axis=0, dtype=np.float64)
    q = np.asarray(end, np.float64) - np.mean(end, axis=0, dtype=np.float64)
    source, target = p.T @ p / len(p), q.T @ q / len(q)
    if np.trace(source) == 0 or np.trace(target) == 0:
        return p, q
    source += RIDGE * np.trace(source) / 3 * np.eye(3)
    target += RIDGE * np.trace(target) / 3 * np.eye(3)
    root, inverse = _matrix_powers(source, 0.5, -0.5)
    gauss_map = inverse @ _matrix_powers(root @ target @ root, 0.5)[0] @ inverse
    root, inverse = _matrix_powers(gauss_map, 0.5, -0.5)
    return p @ root, q @ inverse


def explained_cost(
    start: Points, end: Points, balanced_start: Points, balanced_end: Points
) -> float:
    """The part of the squared-distance cost that `balance` removes, which all plans have."""
    shift = np.mean(end, axis=0) - np.mean(start, axis=0)
    moments = _moment(start - np.mean(start, axis=0)) + _moment(end - np.mean(end, axis=0))
    return float(shift @ shift) + moments - _moment(balanced_start) - _moment(balanced_end)


def _moment(points: Points) -> float:
    return float(np.einsum("ij,ij->", points, points)) / len(points)


def _matrix_powers(matrix: NDArray[np.float64], *exponents: float) -> list[NDArray[np.float64]]:
    values, vectors = np.linalg.eigh((matrix + matrix.T) / 2)
    return [
        (vectors * np.maximum(values, TINY if exponent < 0 else 0.0) ** exponent) @ vectors.T
        for exponent in exponents
    ]


def nearest(start: Points, end: Points, k: int) -> Edges:
    """The pairs of each point with its k nearest points of the other cloud (section 3.4)."""
    from scipy.spatial import KDTree

    n, m = len(start), len(end)
    in_end = KDTree(end).query(start, min(k, m))[1].reshape(n, -1)
    in_start = KDTree(start).query(end, min(k, n))[1].reshape(m, -1)
    return unique(
        (np.repeat(np.arange(n), in_end.shape[1]), in_end.ravel()),
        (in_start.ravel(), np.repeat(np.arange(m), in_start.shape[1])),
    )


def unique(*supports: Edges) -> Edges:
    """The union of supports, sorted by row, then column.

    Equivalent to ``np.unique(np.concatenate(supports, axis=1), axis=1)``.
    """
    rows = np.concatenate([rows for rows, _ in supports]).astype(np.int64)
    columns = np.concatenate([columns for _, columns in supports]).astype(np.int64)
    width = int(columns.max(initial=0)) + 1
    keys = rows * width + columns
    keys.sort()  # np.unique uses a hash table, which takes ten times as long here
    return np.divmod(keys[np.diff(keys, prepend=-1) > 0], width)
