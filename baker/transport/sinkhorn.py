"""The paper's regularised transport (3.4, equations 2-5) on a sparse support, in the log domain."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from baker.transport.problem import (
    Edges,
    Indices,
    Plan,
    Points,
    TransportOptions,
    costs,
    make_plan,
    uniform_masses,
)
from baker.transport.space_partition import bisection_plan
from baker.transport.support import balance, nearest, unique

FEASIBLE_PLANS = 4  # bisections whose pairs join the support; one alone is a bottleneck
OVER_RELAXATION = 1.8  # 7 to 10 times fewer iterations than 1
CHEAP_ITERATIONS = 50  # cheap iterations after one in the log domain
STALLED_BLOCKS = 5  # on an infeasible support, blocks without progress before giving up
MIN_PROGRESS = 0.01  # the share by which the error must fall meanwhile
MIN_MASS = 1e-12  # share of a point's mass below which a pair carries nothing


class Scaling(NamedTuple):
    """Where Sinkhorn's iterations ended; the column sums are exact to rounding."""

    mass: NDArray[np.float64]  # (E,) T's entries on the support
    error: float  # L1 error of the row sums
    iterations: int  # updates of both u and v


def regularized_plan(start: Points, end: Points, options: TransportOptions) -> Plan:
    """Sinkhorn's plan between two segments; always a usable one.

    On the paper's plain support (`feasible=False`) often only a part of the mass can flow. The
    plan is then where the iterations stall, and the notes give its marginal error.
    """
    n, m = len(start), len(end)
    source, target, support = _support(start, end, options)
    cost = costs(source, target, support, options.power)
    typical = float(np.median(cost) or cost.mean() or 1.0)  # most costs may be zero, or all
    found = scale(
        support, cost / (options.gamma * typical), n, m,
        options.tolerance, options.iterations, options.feasible,
    )  # fmt: skip
    notes = []
    if found.error >= options.tolerance:
        notes.append(
            f"stopped after {found.iterations} iterations at a marginal error of {found.error:.2g}"
        )
    kept, mass = _usable(support, cost, found.mass, n, m)
    return make_plan(start, end, kept, mass, options.power, "sinkhorn", notes=notes)


def _support(start: Points, end: Points, options: TransportOptions) -> tuple[Points, Points, Edges]:
    """The points whose distances are the costs, and the pairs that may carry mass."""
    source, target = start - start.mean(axis=0), end - start.mean(axis=0)
    if not options.feasible:
        return source, target, nearest(source, target, options.neighbors)
    balanced = balance(start, end)
    if options.power == 2:
        # The same plan solves both, regularised or not: the costs differ by terms of the row and
        # of the column alone, which u and v take in.
        source, target = balanced
    masses = uniform_masses(len(start), len(end))
    plans = [bisection_plan(*balanced, *masses, options.seed + i)[0] for i in range(FEASIBLE_PLANS)]
    return source, target, unique(nearest(source, target, options.neighbors), *plans)


def scale(
    support: Edges,
    cost: NDArray[np.float64],
    n: int,
    m: int,
    tolerance: float,
    iterations: int,
    feasible: bool = True,
) -> Scaling:
    """Sinkhorn's iterations u = a / Kv, v = b / K'u with K = exp(-cost), a = 1 / n, b = 1 / m.

    Costs may be of any size: every 50 iterations u and v are absorbed into potentials, with one
    iteration in the log domain; cheap iterations that would leave the range of floats are dropped.

    support: rows and columns of the pairs, ordered by row; every row and column is in a pair. cost:
    (E,) in units of gamma. Iterations stop at an L1 error of the marginals of `tolerance`, and are
    over-relaxed if all mass can flow on the support (`feasible`); if not, they stop where they
    stall.

    References
    ----------
    T. Lehmann et al.: A note on overrelaxation in the Sinkhorn algorithm, Optim. Lett. 16 (2022).
    B. Schmitzer: Stabilized sparse scaling algorithms, SIAM J. Sci. Comput. 41 (2019).
    """
    from scipy.sparse import csr_matrix

    rows, columns = support
    by_column = np.argsort(columns, kind="stable")
    row_start = np.searchsorted(rows, np.arange(n))
    column_start = np.searchsorted(columns[by_column], np.arange(m))
    potential = np.zeros(m)
    errors: list[float] = []
    done, relaxation = 0, OVER_RELAXATION if feasible else 1.0
    while True:
        row_potential = -np.log(n) - _log_sum_exp(potential[columns] - cost, rows, row_start)
        exponent = row_potential[rows] - cost
        potential = -np.log(m) - _log_sum_exp(exponent[by_column], columns[by_column], column_start)
        mass = np.exp(exponent + potential[columns])
        done += 1
        errors.append(float(np.abs(np.bincount(rows, mass, n) - 1.0 / n).sum()))
        stalled = (
            not feasible
            and len(errors) > STALLED_BLOCKS
            and errors[-1] > (1.0 - MIN_PROGRESS) * errors[-1 - STALLED_BLOCKS]
        )
        if errors[-1] < tolerance or done >= iterations or stalled:
            return Scaling(mass, errors[-1], done)
        if errors[-1] > 1.5 * min(errors):  # over-relaxation is only sure to converge near the end
            relaxation = (1.0 + relaxation) / 2.0
        kernel = csr_matrix((mass, columns, np.append(row_start, len(rows))), shape=(n, m))
        v, cheap = _iterate(kernel, min(CHEAP_ITERATIONS, iterations - done - 1), relaxation)
        potential += np.log(v)
        done += cheap


def _iterate(kernel: Any, count: int, relaxation: float) -> tuple[NDArray[np.float64], int]:
    """v after up to `count` over-relaxed iterations from u = v = 1, and how many those were."""
    n, m = kernel.shape
    u, v = np.ones(n), np.ones(m)
    for taken in range(count):
        with np.errstate(all="ignore"):
            next_u = u ** (1.0 - relaxation) * (n * (kernel @ v)) ** -relaxation
            next_v = v ** (1.0 - relaxation) * (m * (kernel.T @ next_u)) ** -relaxation
            size = max(next_u.max(), next_v.max(), 1.0 / next_u.min(), 1.0 / next_v.min())
        if not size < 1e100:
            return v, taken
        u, v = next_u, next_v
    return v, count


def _log_sum_exp(
    values: NDArray[np.float64], group: Indices, first: Indices
) -> NDArray[np.float64]:
    """log(sum(exp(values))) of each group of neighbouring entries."""
    top = np.maximum.reduceat(values, first)
    return top + np.log(np.add.reduceat(np.exp(values - top[group]), first))


def _usable(
    support: Edges, cost: NDArray[np.float64], mass: NDArray[np.float64], n: int, m: int
) -> tuple[Edges, NDArray[np.float64]]:
    """Drop pairs that carry next to nothing; a point left without any keeps its nearest pair."""
    kept = mass > MIN_MASS / max(n, m)
    by_cost = np.argsort(cost, kind="stable")
    for side, count in zip(support, (n, m), strict=True):
        touched = np.zeros(count, bool)
        touched[side[kept]] = True
        points, first = np.unique(side[by_cost], return_index=True)
        kept[by_cost[first[~touched[points]]]] = True
    return (support[0][kept], support[1][kept]), mass[kept]
