"""How far apart two segments are: the Wasserstein distance, exact or estimated."""

import numpy as np

from baker.transport.multiscale import couple
from baker.transport.problem import Points, TransportOptions, costs, uniform_masses
from baker.transport.solve import solve
from baker.transport.space_partition import cut
from baker.transport.support import balance, explained_cost


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
