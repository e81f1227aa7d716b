"""Regularised transport by Sinkhorn iterations on a sparse support (section 3.4, eqs. 2 to 5)."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.transport.problem import (
    Edges,
    Indices,
    Points,
    TransportOptions,
    balance,
    costs,
    uniform_masses,
)
from baker.transport.space_partition import bisection_plan

Floats = NDArray[np.float64]

FEASIBLE_PLANS = 4  # number of bisection plans that are added to the support
OVER_RELAXATION = 1.8  # needs 7 to 10 times fewer iterations than 1
CHEAP_ITERATIONS = 50  # number of plain iterations after each one in the log domain
STALLED_BLOCKS = 5  # number of such blocks of iterations without progress, after which it stops
MIN_PROGRESS = 0.01  # relative decrease of the error that counts as progress
MIN_MASS = 1e-12  # share of a point's mass below which a pair is dropped


def regularized_plan(
    start: Points, end: Points, options: TransportOptions
) -> tuple[Edges, Floats, tuple[str, ...]]:
    """Compute Sinkhorn's plan between two segments: pairs, their masses, and notes for the report.

    On the plain support of the paper (`feasible=False`), often only a part of the mass can be
    transported. The iterations then end where they stall, and the notes give the marginal error.
    """
    n, m = len(start), len(end)
    source, target, support = _support(start, end, options)
    cost = costs(source, target, support, options.power)
    typical = float(np.median(cost) or cost.mean() or 1.0)  # most or all costs may be zero
    in_gamma = cost / (options.gamma * typical)
    mass, error, iterations = sinkhorn_scaling(support, in_gamma, n, m, options)
    note = f"stopped after {iterations} iterations at a marginal error of {error:.2g}"
    notes = (note,) if error >= options.tolerance else ()
    return *_drop_small(support, cost, mass, n, m), notes


def _support(start: Points, end: Points, options: TransportOptions) -> tuple[Points, Points, Edges]:
    """The points whose distances are the costs, and the pairs that may carry mass."""
    source, target = start - start.mean(axis=0), end - start.mean(axis=0)
    if not options.feasible:
        return source, target, nearest_pairs(source, target, options.neighbors)
    balanced = balance(start, end)
    if options.power == 2:
        # The plan is the same: the costs differ only by terms of the rows and of the columns.
        source, target = balanced
    masses = uniform_masses(len(start), len(end))
    plans = [bisection_plan(*balanced, *masses, i)[0] for i in range(FEASIBLE_PLANS)]
    return source, target, union(nearest_pairs(source, target, options.neighbors), *plans)


def sinkhorn_scaling(
    support: Edges, cost: Floats, n: int, m: int, options: TransportOptions
) -> tuple[Floats, float, int]:
    """Sinkhorn's iterations u = a / Kv, v = b / K'u with K = exp(-cost), a = 1 / n, b = 1 / m.

    Costs may be of any size: every 50 iterations, u and v are absorbed into potentials by one
    iteration in the log domain; plain iterations that would overflow are dropped. Iterations end at
    the `tolerance` of the L1 error of the marginals. They are over-relaxed if all mass can be
    transported on the support (`feasible`); if not, they also end where they stall.

    support: pairs sorted by row, with every row and column. cost: (E,) in units of gamma. Returns
    the (E,) masses, whose column sums are exact up to rounding, the L1 error of the row sums, and
    the number of updates of both u and v.

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
    done, relaxation = 0, OVER_RELAXATION if options.feasible else 1.0
    while True:
        row_potential = -np.log(n) - _log_sum_exp(potential[columns] - cost, rows, row_start)
        exponent = row_potential[rows] - cost
        potential = -np.log(m) - _log_sum_exp(exponent[by_column], columns[by_column], column_start)
        mass = np.exp(exponent + potential[columns])
        done += 1
        errors.append(float(np.abs(np.bincount(rows, mass, n) - 1.0 / n).sum()))
        before = errors[-1 - STALLED_BLOCKS] if len(errors) > STALLED_BLOCKS else np.inf
        stalled = not options.feasible and errors[-1] > (1.0 - MIN_PROGRESS) * before
        if errors[-1] < options.tolerance or done >= options.iterations or stalled:
            return mass, errors[-1], done
        if errors[-1] > 1.5 * min(errors):  # over-relaxation may diverge far from the solution
            relaxation = (1.0 + relaxation) / 2.0
        kernel = csr_matrix((mass, columns, np.append(row_start, len(rows))), shape=(n, m))
        count = min(CHEAP_ITERATIONS, options.iterations - done - 1)
        v, cheap = _iterate(kernel, count, relaxation)
        potential += np.log(v)
        done += cheap


def _iterate(kernel: Any, count: int, relaxation: float) -> tuple[NDArray[np.float64], int]:
    """v after at most `count` over-relaxed iterations from u = v = 1, and their number."""
    n, m = kernel.shape
    u, v = np.ones(n), np.ones(m)
    for done in range(count):
        with np.errstate(all="ignore"):
            next_u = u ** (1.0 - relaxation) * (n * (kernel @ v)) ** -relaxation
            next_v = v ** (1.0 - relaxation) * (m * (kernel.T @ next_u)) ** -relaxation
            size = max(next_u.max(), next_v.max(), 1.0 / next_u.min(), 1.0 / next_v.min())
        if not size < 1e100:
            return v, done
        u, v = next_u, next_v
    return v, count


def _log_sum_exp(values: Floats, group: Indices, first: Indices) -> Floats:
    """log(sum(exp(values))) of each group of consecutive entries."""
    top = np.maximum.reduceat(values, first)
    return top + np.log(np.add.reduceat(np.exp(values - top[group]), first))


def _drop_small(support: Edges, cost: Floats, mass: Floats, n: int, m: int) -> tuple[Edges, Floats]:
    """Drop pairs with hardly any mass, but keep the largest or else cheapest pair of each point."""
    is_kept = mass > MIN_MASS / max(n, m)
    for side in support:
        order = np.lexsort((cost, -mass, side))
        is_kept[order[np.unique(side[order], return_index=True)[1]]] = True
    return (support[0][is_kept], support[1][is_kept]), mass[is_kept]


def nearest_pairs(start: Points, end: Points, k: int) -> Edges:
    """The pairs of each point with its k nearest points of the other cloud (section 3.4)."""
    from scipy.spatial import cKDTree

    n, m = len(start), len(end)
    in_end = cKDTree(end).query(start, min(k, m))[1].reshape(n, -1)
    in_start = cKDTree(start).query(end, min(k, n))[1].reshape(m, -1)
    return union(
        (np.repeat(np.arange(n), in_end.shape[1]), in_end.ravel()),
        (in_start.ravel(), np.repeat(np.arange(m), in_start.shape[1])),
    )


def union(*supports: Edges) -> Edges:
    """The union of supports, sorted by row, then column.

    Equivalent to ``np.unique(np.concatenate(supports, axis=1), axis=1)``.
    """
    rows = np.concatenate([rows for rows, _ in supports]).astype(np.int64)
    columns = np.concatenate([columns for _, columns in supports]).astype(np.int64)
    width = int(columns.max(initial=0)) + 1
    keys = rows * width + columns
    keys.sort()  # np.unique uses a hash table, which takes ten times as long here
    return np.divmod(keys[np.diff(keys, prepend=-1) > 0], width)
