"""How much of the mass a support can carry: the paper's is often infeasible."""

from __future__ import annotations

import numpy as np

from baker.transport.problem import Edges, uniform_masses


def share_that_can_flow(edges: Edges, n: int, m: int) -> float:
    """Share of uniform marginals that can be transported on a support, by maximum flow.

    Parameters
    ----------
    edges : pair of (E,) int
        Rows and columns of the pairs that may carry mass, each pair once.
    n, m : int
        Number of rows and of columns.

    Returns
    -------
    float
        1 if all of the mass can flow: the transport problem is then feasible.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import maximum_flow

    supply, demand = uniform_masses(n, m)
    source, sink = n + m, n + m + 1
    tails = np.concatenate([np.full(n, source), np.arange(n, n + m), edges[0]])
    heads = np.concatenate([np.arange(n), np.full(m, sink), n + edges[1]])
    capacities = np.concatenate([supply, demand, np.minimum(supply[edges[0]], demand[edges[1]])])
    network = csr_array((capacities.astype(np.int32), (tails, heads)), shape=(sink + 1, sink + 1))
    flow = maximum_flow(network, source, sink).flow
    # The flow through an edge fits 32 bits, their sum need not: `flow_value` would wrap around.
    leaving = flow.data[flow.indptr[source] : flow.indptr[source + 1]]
    return int(leaving.sum(dtype=np.int64)) / int(supply.sum())
