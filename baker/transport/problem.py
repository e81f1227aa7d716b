"""The transport problem of two segments: its options, its masses and costs, and a plan."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gclip.morton import morton_order

if TYPE_CHECKING:
    from scipy.spatial import KDTree

Points = NDArray[np.floating]
Indices = NDArray[np.integer]
Masses = NDArray[np.int64]  # whole units: n points supply m / g each, m points demand n / g each
Edges = tuple[Indices, Indices]  # rows and columns of the pairs that may carry mass

# Of the masses that both clouds have.
NEIGHBORS = 10  # points, within whose distance the other cloud's are counted
MIN_SHARE = 0.02  # of a uniform mass: every point is moved
MAX_SAMPLE = 250  # points of a cloud, each for those after it along the Morton curve
TOTAL_MASS = 10**9  # whole units


@dataclass(frozen=True)
class TransportOptions:
    """How to solve the transport problem of one pair of segments (section 3.4)."""

    method: Literal["exact", "sinkhorn"] = "exact"
    power: Literal[1, 2] = 2  # the cost is distance ** power; the paper's is 1
    neighbors: int = 15  # Sinkhorn: k of the k-nearest-neighbour support, both ways
    gamma: float = 0.3  # Sinkhorn's regularisation, relative to the support's median cost
    feasible: bool = True  # Sinkhorn: add feasible plans' pairs to the paper's support
    tolerance: float = 1e-3  # Sinkhorn stops at this L1 error of the marginals ...
    iterations: int = 2000  # ... or after so many iterations
    seed: int = 0  # directions of the bisections that give first plans; any gives a good plan
    workers: int = 1  # threads of the exact method; the plan is the same whatever their number
    shared: bool = False  # exact: masses by what both segments have around a point, not uniform


@dataclass(frozen=True)
class Plan:
    """A transport plan: a sparse coupling of two segments, each of mass 1."""

    rows: NDArray[np.int32]  # (E,) points of the start; ordered by row, then column
    columns: NDArray[np.int32]  # (E,) points of the end
    mass: NDArray[np.float64]  # (E,) what flows between them
    cost: float  # sum of mass times distance ** power
    distance: float  # cost ** (1 / power): the Wasserstein distance in the points' unit
    marginal_error: float  # L1 error of the row sums plus that of the column sums
    solver: str  # "network simplex", "sinkhorn", or "only choice"
    notes: tuple[str, ...] = ()  # for the report, one sentence each


def costs(start: Points, end: Points, edges: Edges, power: int) -> NDArray[np.float64]:
    """(E,) the costs of pairs of points, (n, 3) and (m, 3).

    Equivalent to ``np.linalg.norm(start[edges[0]] - end[edges[1]], axis=1) ** power``.
    """
    displacement = start.take(edges[0], axis=0).astype(np.float64, copy=False)
    displacement -= end.take(edges[1], axis=0)
    squared = np.zeros(len(displacement))
    for axis in displacement.T:
        squared += axis**2
    return squared if power == 2 else np.sqrt(squared)


def make_plan(
    start: Points,
    end: Points,
    edges: Edges,
    mass: ArrayLike,
    power: int,
    solver: str,
    *,
    notes: Sequence[str] = (),
    masses: tuple[Masses, Masses] | None = None,
) -> Plan:
    """Order a coupling's pairs, and compute its cost and the error of its marginals.

    mass: (E,), of sum 1; masses: the marginals, of equal sums, uniform by default.
    """
    order = np.argsort(edges[0].astype(np.int64) * len(end) + edges[1], kind="stable")
    rows, columns = edges[0][order], edges[1][order]
    flow = np.asarray(mass, np.float64)[order]
    cost = float(flow @ costs(start, end, (rows, columns), power))
    supply, demand = masses or uniform_masses(len(start), len(end))
    return Plan(
        rows.astype(np.int32),
        columns.astype(np.int32),
        flow,
        cost,
        cost ** (1.0 / power),
        _marginal_error(rows, flow, supply) + _marginal_error(columns, flow, demand),
        solver,
        tuple(notes),
    )


def _marginal_error(indices: Indices, mass: NDArray[np.float64], marginal: Masses) -> float:
    """L1 error of one side's sums, from a marginal in whole units."""
    sums = np.bincount(indices, mass, len(marginal))
    return float(np.abs(sums - marginal / marginal.sum()).sum())


def uniform_masses(n: int, m: int) -> tuple[Masses, Masses]:
    """The smallest whole masses that are uniform on either side and have the same sum."""
    common = math.gcd(n, m)
    return np.full(n, m // common), np.full(m, n // common)


def shared_masses(start: Points, end: Points) -> tuple[Masses, Masses]:
    """Masses of registered clouds, by how much of the other cloud is around each point.

    A point's mass is the number of the other cloud's points that are no farther than its tenth
    neighbour in its own cloud, of as many points; fully from ten on. Of large clouds a sample is
    looked at. In whole units, at least 1, of equal sums.
    """
    from scipy.spatial import KDTree

    k = min(NEIGHBORS, len(start), len(end))
    if k < 2:
        shares = np.ones(len(start)), np.ones(len(end))
    else:
        source, target = (KDTree(points, balanced_tree=False) for points in (start, end))
        shares = _share(source, target, k), _share(target, source, k)
    supply, demand = (np.maximum(1, TOTAL_MASS * (s / s.sum())).astype(np.int64) for s in shares)
    # What rounding has taken goes to the largest, of which it is next to nothing.
    supply[np.argmax(supply)] += max(0, int(demand.sum() - supply.sum()))
    demand[np.argmax(demand)] += max(0, int(supply.sum() - demand.sum()))
    return supply, demand


def _share(own: "KDTree", other: "KDTree", k: int) -> NDArray[np.float64]:
    order, step = morton_order(own.data), -(-own.n // MAX_SAMPLE)
    sample = own.data[order[::step]]
    radius = own.query(sample, k=[k])[0][:, 0] * 1.0001
    found = other.query_ball_point(sample, radius, return_length=True)
    share = np.empty(own.n)
    share[order] = np.clip(found / other.n * own.n / k, MIN_SHARE, 1.0).repeat(step)[: own.n]
    return share
