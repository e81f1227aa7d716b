"""How much of the mass a support can carry: the paper's is often infeasible."""

from __future__ import annotations

import numpy as np

from baker.transport.problem import Edges, uniform_masses


def share_that_can_flow(edges: Edges, n: int, m: int) -> float:
    """How much of the mass of uniform marginals can flow on a support, by maximum flow; 1: all."""
    from ortools.graph.python.max_flow import SimpleMaxFlow

    supply, demand = uniform_masses(n, m)
    source, sink = n + m, n + m + 1
    tails = [np.full(n, source), np.arange(n, n + m), edges[0]]
    heads = [np.arange(n), np.full(m, sink), n + edges[1]]
    capacities = [supply, demand, np.minimum(supply[edges[0]], demand[edges[1]])]
    solver = SimpleMaxFlow()
    for tail, head, capacity in zip(tails, heads, capacities, strict=True):
        solver.add_arcs_with_capacity(tail.astype(np.int32), head.astype(np.int32), capacity)
    if solver.solve(source, sink) != solver.OPTIMAL:
        raise RuntimeError("OR-Tools' maximum flow failed")
    return solver.optimal_flow() / int(supply.sum())
