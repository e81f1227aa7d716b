"""Which pairs of points may carry mass.

Two ideas make a few neighbours enough where the paper's k = 15 usually can't carry all of the
mass: look for neighbours after the part of the motion that a linear map explains has been taken
out (`balance`), and start from a plan that is feasible by construction (`bisection`).
"""

import numpy as np
from numpy.typing import NDArray

from baker.transport.problem import Edges, Points

TINY = float(np.finfo(float).tiny)
RIDGE = 1e-4  # share of the mean variance added to each axis, so that flat segments are invertible


def balance(start: Points, end: Points) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Centre both clouds and map them linearly so that their covariances agree.

    The optimal plan stays the same. It has the largest sum of <p, q>, and <p, q> = <A p, A^-T q>
    for every invertible A. With S the optimal map between the Gaussians of the same moments
    (S Cov(p) S = Cov(q)), A = S^1/2 takes translation, growth and stretching out of the cost, and
    what is left is what the solver must decide.

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
    ahead, back = _matrix_powers(gauss_map, 0.5, -0.5)
    return p @ ahead, q @ back


def explained_cost(
    start: Points, end: Points, balanced_start: Points, balanced_end: Points
) -> float:
    """The part of the squared-distance cost that `balance` takes out, the same for every plan."""
    shift = np.mean(end, axis=0) - np.mean(start, axis=0)
    before = _moment(start - np.mean(start, axis=0)) + _moment(end - np.mean(end, axis=0))
    return float(shift @ shift) + before - _moment(balanced_start) - _moment(balanced_end)


def _moment(points: Points) -> float:
    return float(np.einsum("ij,ij->", points, points)) / len(points)


def _matrix_powers(matrix: NDArray[np.float64], *exponents: float) -> list[NDArray[np.float64]]:
    values, vectors = np.linalg.eigh((matrix + matrix.T) / 2)
    return [
        (vectors * np.maximum(values, TINY if exponent < 0 else 0.0) ** exponent) @ vectors.T
        for exponent in exponents
    ]


def nearest(start: Points, end: Points, k: int) -> Edges:
    """Pairs of every point with its k nearest ones on the other side, both ways (section 3.4)."""
    from scipy.spatial import KDTree

    n, m = len(start), len(end)
    ahead = KDTree(end).query(start, min(k, m))[1].reshape(n, -1)
    back = KDTree(start).query(end, min(k, n))[1].reshape(m, -1)
    return unique(
        (np.repeat(np.arange(n), ahead.shape[1]), ahead.ravel()),
        (back.ravel(), np.repeat(np.arange(m), back.shape[1])),
    )


def unique(*supports: Edges) -> Edges:
    """The union of supports, ordered by row, then column.

    Equivalent to ``np.unique(np.concatenate(supports, axis=1), axis=1)``.
    """
    rows = np.concatenate([rows for rows, _ in supports]).astype(np.int64)
    columns = np.concatenate([columns for _, columns in supports]).astype(np.int64)
    width = int(columns.max(initial=0)) + 1
    keys = rows * width + columns
    keys.sort()  # np.unique hashes integers, ten times slower here
    return np.divmod(keys[np.diff(keys, prepend=-1) > 0], width)
