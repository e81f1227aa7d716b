"""A pair of segments: its transport plan, and its Wasserstein distance (paper, section 3.4)."""

import numpy as np

from baker.transport.multiscale import MAX_POINTS_PRICED_AT_ONCE, couple
from baker.transport.problem import (
    Plan,
    Points,
    TransportOptions,
    costs,
    make_plan,
    shared_masses,
    uniform_masses,
)
from baker.transport.sinkhorn import regularized_plan
from baker.transport.space_partition import cut
from baker.transport.support import balance, explained_cost


def solve(start: Points, end: Points, options: TransportOptions | None = None) -> Plan:
    """The transport plan between a segment's points at two times.

    Minimises sum(T * distance ** power) over all couplings T with the segments' masses. Clouds that
    are small together (n m up to 1.5 million) are solved to the optimum, others to within 1 %.

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
    if options.method == "sinkhorn":
        return regularized_plan(start, end, options)

    n, m = len(start), len(end)
    # Where the clouds are does not matter to squared distances, only to rounding.
    source = start - start.mean(axis=0)
    target = end - (end if options.power == 2 else start).mean(axis=0)
    # Of few points all pairs are looked at: it does not matter how they lie.
    if options.power == 2 and min(n, m) > MAX_POINTS_PRICED_AT_ONCE:
        source, target = balance(start, end)
    masses = shared_masses(start, end) if options.shared else uniform_masses(n, m)
    edges, mass, solver = couple(source, target, *masses, options)
    return make_plan(start, end, edges, mass / mass.sum(), options.power, solver, masses=masses)


def wasserstein(start: Points, end: Points, *, samples: int = 256, seed: int = 0) -> float:
    """2-Wasserstein distance of two segments.

    Exact where neither side has more than `samples` points. Above, each side is replaced by the
    centroids of `samples` compact blocks of its points, in what is left after the closed-form
    Gaussian part, which uses all points. Measured on organs of real plants: within 1.3 % at 256
    samples in 10 ms, but up to 6 % where the distance is that between the points.

    Parameters
    ----------
    start, end : (n, 3) and (m, 3) float ndarray
        Length units.
    samples : int
    seed : int
        Of the directions of cuts.

    Returns
    -------
    float
        Length units.
    """
    start, end = np.asarray(start, np.float64), np.asarray(end, np.float64)
    options = TransportOptions(seed=seed)
    if max(len(start), len(end)) <= samples:
        return solve(start, end, options).distance
    source, target = balance(start, end)
    known = explained_cost(start, end, source, target)
    rows, columns = (cut(cloud, samples, seed) for cloud in (source, target))
    supply, demand = uniform_masses(len(start), len(end))
    centres = rows.centroids(source), columns.centroids(target)
    edges, mass, _ = couple(*centres, rows.masses(supply), columns.masses(demand), options)
    left = float(mass @ costs(*centres, edges, options.power)) / float(supply.sum())
    return max(known + left, 0.0) ** 0.5
