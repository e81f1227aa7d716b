"""Segment thin structures without labels and build their hierarchy (section 3.2.2 of the paper).

The minimum spanning tree of the points is traversed from the root. Where more than one branch is
longer than a threshold, the tree bifurcates, and each of these branches is a new segment.
"""

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import RootedTree, chain_ends, spanning_tree
from baker.geometry.neighbors import Neighbors
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy, split_by_label

DEFAULT_THRESHOLD = 0.18  # c, as a share of the longest path from the root


def hierarchy_from_spanning_tree(
    points: NDArray[np.floating],
    root: int,
    neighbors: Neighbors | None = None,
    k: int = 15,
    threshold: int | None = None,
) -> Hierarchy:
    """Segment a cloud at the bifurcations of its minimum spanning tree.

    Parameters
    ----------
    points : (N, 3) float ndarray
    root : int
        Index of the point at the plant base.
    neighbors : Neighbors, optional
    k : int
        Number of neighbours in the kNN graph.
    threshold : int, optional
        The paper's c: the longest path of a segment has more edges. By default 18 % of the
        longest path from the root.

    References
    ----------
    Section 3.2.2 of the paper.
    """
    tree = spanning_tree(points, root, k, neighbors)
    longest = longest_paths(tree)
    c = round(DEFAULT_THRESHOLD * int(longest[root])) if threshold is None else threshold
    return _hierarchy(tree, _segment_starts(tree, longest, c))


def longest_paths(tree: RootedTree) -> NDArray[np.intp]:
    """(N,) the paper's m_v: number of edges of the longest path from each point to a leaf."""
    longest, parent = [0] * len(tree.order), tree.parent.tolist()
    for point in tree.order[:0:-1].tolist():
        longest[parent[point]] = max(longest[parent[point]], longest[point] + 1)
    return np.array(longest)


def _segment_starts(
    tree: RootedTree, longest: NDArray[np.intp], threshold: int
) -> NDArray[np.bool_]:
    """(N,) whether a segment starts at a point: at the root, and at long branches of a fork."""
    child = tree.order[1:]
    long = child[longest[child] > threshold]
    branches = np.bincount(tree.parent[long], minlength=len(tree.order))
    starts = np.zeros(len(tree.order), bool)
    starts[long[branches[tree.parent[long]] > 1]] = True
    starts[tree.order[0]] = True
    return starts


def _hierarchy(tree: RootedTree, starts: NDArray[np.bool_]) -> Hierarchy:
    """Number the segments from the root; a point is in the segment of its nearest start above."""
    heads = tree.order[starts[tree.order]]
    number = np.empty(len(starts), np.intp)
    number[heads] = np.arange(len(heads))
    segment = number[chain_ends(np.where(starts, np.arange(len(starts)), tree.parent))]
    _, members = split_by_label(segment)
    parents = [NO_PARENT, *segment[tree.parent[heads[1:]]].tolist()]
    notes: tuple[str, ...] = ()
    if tree.bridges:
        notes = (f"{tree.bridges} gaps in the cloud bridged, the widest {tree.widest:.3g}",)
    return Hierarchy(tuple(members), (None,) * len(heads), tuple(parents), 0, notes)
