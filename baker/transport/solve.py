"""The transport plan and the Wasserstein distance of two segments (section 3.4 of the paper)."""

import numpy as np

from baker.transport.multiscale import MAX_POINTS_PRICED_AT_ONCE, multiscale_plan
from baker.transport.problem import (
    Plan,
    Points,
    TransportOptions,
    balance,
    costs,
    overlap_masses,
    uniform_masses,
)
from baker.transport.sinkhorn import regularized_plan
from baker.transport.space_partition import bisection_order, blocks


def solve(start: Points, end: Points, options: TransportOptions | None = None) -> Plan:
    """Compute the optimal transport plan between two segments.

    It minimises sum(T * distance ** power) over all couplings T with the given masses. For clouds
    with n m up to 1.5 million the plan is optimal, for larger ones within 1 % of the optimum.

    Parameters
    ----------
    start, end : (n, 3) and (m, 3) float array-like
        Finite positions in length units, in any order, duplicates allowed.
    options : TransportOptions, optional

    Returns
    -------
    Plan

    References
    ----------
    Section 3.4 of the paper, equation 1.

    Examples
    --------
    >>> plan = solve([[0, 0, 0], [1, 0, 0]], [[0, 0, 1], [1, 0, 1]])
    >>> plan.rows.tolist(), plan.columns.tolist(), plan.distance
    ([0, 1], [0, 1], 1.0)
    """
    options = options or TransportOptions()
    start, end = np.asarray(start, np.float64), np.asarray(end, np.float64)
    n, m = len(start), len(end)
    if options.method == "sinkhorn":
        masses, solver = uniform_masses(n, m), "sinkhorn"
        edges, flow, notes = regularized_plan(start, end, options)
    else:
        # For squared distances, translations change rounding errors only.
        source = start - start.mean(axis=0)
        target = end - (end if options.power == 2 else start).mean(axis=0)
        # `balance` improves the choice of pairs to price; of few points, all pairs are priced.
        if options.power == 2 and min(n, m) > MAX_POINTS_PRICED_AT_ONCE:
            source, target = balance(start, end)
        masses = overlap_masses(start, end) if options.overlap else uniform_masses(n, m)
        edges, mass = multiscale_plan(source, target, *masses, options)
        flow, solver, notes = mass / mass.sum(), "network simplex", ()
    order = np.argsort(edges[0].astype(np.int64) * m + edges[1], kind="stable")
    rows, columns = (side[order].astype(np.int32) for side in edges)
    flow = flow[order]
    cost = float(flow @ costs(start, end, (rows, columns), options.power))
    distance = cost ** (1.0 / options.power)
    errors = [
        np.abs(np.bincount(side, flow, len(marginal)) - marginal / marginal.sum()).sum()
        for side, marginal in zip((rows, columns), masses, strict=True)
    ]
    return Plan(rows, columns, flow, cost, distance, float(sum(errors)), solver, notes)


def wasserstein(start: Points, end: Points, *, samples: int = 256) -> float:
    """Compute the 2-Wasserstein distance of two segments.

    It is exact if both have at most `samples` points. Otherwise the Gaussian part is computed in
    closed form from all points, and the rest from the centroids of `samples` blocks of each
    segment. On organs of real plants it is within 1.3 % of the exact distance with 256 samples, in
    10 ms; within 6 % if it is as small as the point spacing.

    Parameters
    ----------
    start, end : (n, 3) and (m, 3) float ndarray
    samples : int
        Number of blocks.

    Returns
    -------
    float
        In the unit of the points.
    """
    start, end = np.asarray(start, np.float64), np.asarray(end, np.float64)
    if max(len(start), len(end)) <= samples:
        return solve(start, end).distance
    source, target = balance(start, end)
    gaussian_cost = explained_cost(start, end, source, target)
    sides = []
    for cloud, mass in zip((source, target), uniform_masses(len(start), len(end)), strict=True):
        order = bisection_order(cloud, seed=0)[0]
        sides.append(blocks(cloud[order], mass, samples))
    (rows, supply), (columns, demand) = sides
    edges, mass = multiscale_plan(rows, columns, supply, demand, TransportOptions())
    remaining_cost = float(mass @ costs(rows, columns, edges, power=2) / supply.sum())
    return max(gaussian_cost + remaining_cost, 0.0) ** 0.5


def explained_cost(
    start: Points, end: Points, balanced_start: Points, balanced_end: Points
) -> float:
    """The part of the squared-distance cost that all plans share and that `balance` removes."""
    shift = end.mean(axis=0) - start.mean(axis=0)
    before = start.var(axis=0).sum() + end.var(axis=0).sum()
    balanced_variance = balanced_start.var(axis=0).sum() + balanced_end.var(axis=0).sum()
    return float(shift @ shift + before - balanced_variance)
