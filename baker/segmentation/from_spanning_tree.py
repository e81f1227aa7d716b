"""Segment thin structures without labels and build their hierarchy (section 3.2.2 of the paper).

The minimum spanning tree of the points is traversed from the root. Where more than one branch is
longer than a threshold, the tree bifurcates, and each of these branches is a new segment.
"""

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import chain_ends, connected_knn_graph
from baker.geometry.neighbors import Neighbors
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy, split_by_label

DEFAULT_THRESHOLD = 0.18  # ratio of the paper's c to the longest path (docs/method.md, row 10)


def hierarchy_from_spanning_tree(
    points: NDArray[np.floating],
    root: int,
    neighbors: Neighbors | None = None,
    k: int = 15,
    threshold: int | None = None,
) -> Hierarchy:
    """Segment (N, 3) points at the bifurcations of their minimum spanning tree (section 3.2.2).

    root: index of the point at the plant base. neighbors: of the points; queried by default.
    k: number of neighbours in the kNN graph. threshold: the paper's c, a number of edges; branches
    with a longer path are segments. It is 18 % of the longest path from the root by default.
    """
    from scipy.sparse.csgraph import breadth_first_order, minimum_spanning_tree

    graph = connected_knn_graph(points, k, neighbors)
    order, parent = breadth_first_order(minimum_spanning_tree(graph), root, directed=False)
    longest = longest_paths(order, parent)
    c = round(DEFAULT_THRESHOLD * int(longest[root])) if threshold is None else threshold
    # A segment starts at the root, and at each of several long branches of a point.
    heads = order[1:][longest[order[1:]] > c]  # the first points of long branches
    branches = np.bincount(parent[heads], minlength=len(points))
    starts = np.append(root, heads[branches[parent[heads]] > 1])
    previous = parent.astype(np.intp)  # in the same segment
    previous[starts] = starts
    number = np.empty(len(points), np.intp)
    number[starts] = np.arange(len(starts))
    segment = number[chain_ends(previous)]
    parents = [NO_PARENT, *segment[parent[starts[1:]]].tolist()]
    gaps = graph.nnz - len(points) * min(k, len(points) - 1)
    notes = (f"{gaps} gaps in the cloud bridged where they are narrowest",) if gaps else ()
    labels = (None,) * len(starts)
    return Hierarchy(tuple(split_by_label(segment)[1]), labels, tuple(parents), 0, notes)


def longest_paths(order: NDArray[np.integer], parent: NDArray[np.integer]) -> NDArray[np.intp]:
    """(N,) the paper's m_v: number of edges of the longest path from each point to a tip.

    order: (N,) points of a tree, parents before their children. parent: (N,) of each point.
    """
    longest, parents = [0] * len(order), parent.tolist()
    for point in order[:0:-1].tolist():
        longest[parents[point]] = max(longest[parents[point]], longest[point] + 1)
    return np.array(longest)
