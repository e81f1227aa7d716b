"""The transport problem of two segments: options, costs, masses and plans."""

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from baker.geometry.morton import morton_order

Points = NDArray[np.floating]
Indices = NDArray[np.integer]
Masses = NDArray[np.int64]  # in integer units, so that sums are exact
Edges = tuple[Indices, Indices]  # rows and columns of the pairs that may carry mass
Coupling = NDArray[np.int64]  # (3, E) rows, columns and masses of the pairs of a feasible plan

# Of `overlap_masses`.
NEIGHBORS = 10  # points of the other cloud are counted within the distance of this neighbour
MIN_SHARE = 0.02  # least mass, as a share of a uniform one, so that every point is transported
MAX_SAMPLE = 2500  # points of a cloud whose masses are computed, along the Morton curve
TOTAL_MASS = 10**9  # of each cloud, in integer units
RIDGE = 1e-4  # of `balance`: share of the mean variance added to each axis of a covariance
TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True)
class TransportOptions:
    """How to solve the transport problem of one pair of segments (section 3.4)."""

    method: Literal["exact", "sinkhorn"] = "exact"
    power: Literal[1, 2] = 2  # the cost is distance ** power; the paper's is 1
    neighbors: int = 15  # Sinkhorn: k of the support, the k nearest neighbours from both sides
    gamma: float = 0.3  # Sinkhorn: regularisation, relative to the support's median cost
    feasible: bool = True  # Sinkhorn: add the pairs of feasible plans to the paper's support
    tolerance: float = 1e-3  # Sinkhorn: L1 error of the marginals at which iterations stop
    iterations: int = 2000  # Sinkhorn: most iterations
    workers: int = 1  # number of threads of the exact method; the plan does not depend on it
    overlap: bool = False  # exact: `overlap_masses` instead of `uniform_masses`


@dataclass(frozen=True)
class Plan:
    """A transport plan: a sparse coupling of two segments, each of mass 1."""

    rows: NDArray[np.int32]  # (E,) points of the start; sorted by row, then column
    columns: NDArray[np.int32]  # (E,) points of the end
    mass: NDArray[np.float64]  # (E,) transported mass
    cost: float  # sum of mass times distance ** power
    distance: float  # cost ** (1 / power): the Wasserstein distance in the points' unit
    marginal_error: float  # L1 error of the row sums plus that of the column sums
    solver: str  # "network simplex" or "sinkhorn"
    notes: tuple[str, ...] = ()  # for the report, one sentence each


def costs(start: Points, end: Points, edges: Edges, power: int) -> NDArray[np.float64]:
    """(E,) costs of pairs of (n, 3) and (m, 3) points.

    Equivalent to ``np.linalg.norm(start[edges[0]] - end[edges[1]], axis=1) ** power``.
    """
    displacement = start.take(edges[0], axis=0).astype(np.float64, copy=False)
    displacement -= end.take(edges[1], axis=0)
    squared = np.einsum("ij,ij->i", displacement, displacement)
    return squared if power == 2 else np.sqrt(squared)


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


def _matrix_powers(matrix: NDArray[np.float64], *exponents: float) -> list[NDArray[np.float64]]:
    """Powers of a symmetric, positive semidefinite matrix."""
    values, vectors = np.linalg.eigh((matrix + matrix.T) / 2)
    return [
        (vectors * np.maximum(values, TINY if exponent < 0 else 0.0) ** exponent) @ vectors.T
        for exponent in exponents
    ]


def uniform_masses(n: int, m: int) -> tuple[Masses, Masses]:
    """The smallest integer masses that are uniform on both sides and have equal sums."""
    common = math.gcd(n, m)
    return np.full(n, m // common), np.full(m, n // common)


def overlap_masses(start: Points, end: Points) -> tuple[Masses, Masses]:
    """Masses of registered clouds, smaller for points without counterparts in the other cloud.

    The mass of a point is proportional to the number of points of the other cloud within the
    distance of its tenth neighbour, at most ten, after correction for the clouds' sizes. For large
    clouds it is computed on a sample. Masses are integers of at least 1, with equal sums.
    """
    from scipy.spatial import cKDTree

    k = min(NEIGHBORS, len(start), len(end))
    if k < 2:
        shares = np.ones(len(start)), np.ones(len(end))
    else:
        source, target = (cKDTree(points, balanced_tree=False) for points in (start, end))
        shares = _share(source, target, k), _share(target, source, k)
    supply, demand = (np.maximum(1, TOTAL_MASS * (s / s.sum())).astype(np.int64) for s in shares)
    # The rounding error is added to the largest mass.
    supply[np.argmax(supply)] += max(0, int(demand.sum() - supply.sum()))
    demand[np.argmax(demand)] += max(0, int(supply.sum() - demand.sum()))
    return supply, demand


def _share(own: Any, target: Any, k: int) -> NDArray[np.float64]:
    """(n,) points of the `target` KD-tree within the k-th `own` neighbour of each point, over k."""
    order, step = morton_order(own.data), -(-own.n // MAX_SAMPLE)
    sample = own.data[order[::step]]
    radius = own.query(sample, k=[k])[0][:, 0] * 1.0001
    counts = target.query_ball_point(sample, radius, return_length=True)
    share = np.empty(own.n)
    share[order] = np.clip(counts / target.n * own.n / k, MIN_SHARE, 1.0).repeat(step)[: own.n]
    return share
