"""The merge tree of a height on a graph: which branches rise above the points where they meet."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import chain_ends

if TYPE_CHECKING:
    from scipy.sparse import spmatrix


def branches(
    height: NDArray[np.floating],
    graph: "spmatrix",
    min_length: float,
    min_share: float = 0.0,
    min_points: int = 1,
) -> NDArray[np.intp]:
    """Number the branches of a height's superlevel sets.

    The connected components of all that is above a level grow as the level falls. Where two of them
    meet, both are complete branches, unless the lower one is but a bump on the other: its rise
    above the meeting point, its persistence, is too small.

    Parameters
    ----------
    height : (N,) float
    graph : (N, N) sparse matrix
        Undirected edges at its non-zeros.
    min_length : float
        Persistence of a branch, at least.
    min_share : float
        The same, relative to that of the branch it meets, if that has met none so far.
    min_points : int
        Points of a branch, at least.

    Returns
    -------
    (N,) intp, the branch of each point, from 0 on; -1 below all meeting points.

    References
    ----------
    Edelsbrunner, Letscher, Zomorodian: Topological persistence and simplification (2002).
    """
    # Points are counted from the highest on: the last of an edge's is the lower one.
    count, descending = len(height), np.argsort(-height, kind="stable")
    rank = np.empty(count, np.intp)
    rank[descending] = np.arange(count)
    edges = graph.tocoo()
    upper, lower = np.sort(rank[np.stack([edges.row, edges.col])], axis=0)
    uphill = np.arange(count)
    np.minimum.at(uphill, lower, upper)
    peak = chain_ends(uphill)
    # Components grow from the peaks, and meet first where the pass between two peaks is highest.
    between = np.flatnonzero(peak[upper] != peak[lower])
    between = between[np.argsort(lower[between], kind="stable")]
    sides = np.sort(peak[np.stack([upper[between], lower[between]])], axis=0)
    first = np.sort(np.unique(sides[0] * count + sides[1], return_index=True)[1])
    component = np.arange(count)  # of each peak, named by its highest
    has_met = np.zeros(count, bool)
    branch, found = np.full(count, -1, np.intp), 0
    for *pair, level in zip(*sides[:, first], lower[between[first]], strict=True):
        high, low = np.sort(component[pair])
        if high == low:
            continue
        above = component[peak[: level + 1]]
        length, rest = height[descending[[low, high]]] - height[descending[level]]
        is_long = length >= min_length and (has_met[high] or length >= min_share * rest)
        if has_met[low] or (is_long and (above == low).sum() >= min_points):
            for side in (high, low):
                if not has_met[side]:
                    branch[: level + 1][above == side] = found
                    found += 1
            has_met[[high, low]] = True
        component[component == low] = high
    return branch[rank]
