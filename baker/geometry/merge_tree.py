"""The merge tree of a height on a graph: which branches rise above the points where they meet."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.sparse import spmatrix


def branches(
    height: NDArray[np.floating],
    graph: spmatrix,
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
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import minimum_spanning_tree

    count = len(height)
    descending = np.argsort(-height, kind="stable")
    rank = np.empty(count, np.intp)
    rank[descending] = np.arange(count)
    edges = graph.tocoo()
    level = np.maximum(rank[edges.row], rank[edges.col])  # of its lower end
    # The edges of this tree alone connect the same points at every level.
    tree = minimum_spanning_tree(csr_matrix((level + 1.0, (edges.row, edges.col)), (count, count)))
    tree = tree.tocoo()
    by_level = np.argsort(tree.data, kind="stable")
    ends = np.stack([tree.row, tree.col], axis=1)[by_level].tolist()
    passes = height[descending[tree.data[by_level].astype(np.intp) - 1]].tolist()

    parent = list(range(count))  # of the union-find forest; a component's root is its highest point
    members = [[point] for point in range(count)]
    met = [False] * count
    branch, found = np.full(count, -1, np.intp), 0

    def root(point: int) -> int:
        while parent[point] != point:
            parent[point] = parent[parent[point]]
            point = parent[point]
        return point

    for (a, b), meeting in zip(ends, passes, strict=True):
        high, low = sorted((root(a), root(b)), key=rank.__getitem__)
        length, rest = height[low] - meeting, height[high] - meeting
        is_branch = met[low] or (length >= min_length and len(members[low]) >= min_points)
        if is_branch and (met[low] or met[high] or length >= min_share * rest):
            for component in (high, low):
                if not met[component]:
                    branch[members[component]] = found
                    found += 1
                    met[component] = True
        parent[low] = high
        if not met[high]:
            members[high] += members[low]
        members[low] = []
    return branch
