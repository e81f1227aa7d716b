"""Connected pieces of a graph, compiled by numba: import this module late.

scipy has them too, but takes longer to load than a scan takes to be looked at.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.geometry.compiled import compiled

Ints = NDArray[np.integer]


@compiled
def pieces(count: int, one: Ints, other: Ints) -> Ints:
    """(count,) the lowest number in the piece of each node; one, other: the ends of all edges."""
    lowest = np.arange(count)
    for edge in range(len(one)):
        a, b = _lowest(lowest, one[edge]), _lowest(lowest, other[edge])
        lowest[max(a, b)] = min(a, b)
    for node in range(count):
        lowest[node] = lowest[lowest[node]]  # that of a lower node is final
    return lowest


@compiled
def _lowest(lowest: Ints, node: int) -> int:
    while lowest[node] != node:
        lowest[node] = lowest[lowest[node]]
        node = lowest[node]
    return node
