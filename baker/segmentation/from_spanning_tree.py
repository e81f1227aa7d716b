"""Segments and hierarchy at once, for thin structures without labels (paper section 3.2.2).

The cloud's minimum spanning tree is walked from the root: where more than one branch goes on for
longer than a threshold, the tree forks, and each of those branches begins a segment of its own.
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
        The point at the plant base.
    neighbors : Neighbors, optional
        Of the points, where they are known.
    k : int
        Neighbors of a point in the graph that the tree spans.
    threshold : int, optional
        The paper's c: branches whose longest path has more edges count. By default 18 % of the
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
    """(N,) m_v: edges on the longest path from each point down to a leaf of its subtree."""
    longest, parent = [0] * len(tree.order), tree.parent.tolist()
    for point in tree.order[:0:-1].tolist():
        longest[parent[point]] = max(longest[parent[point]], longest[point] + 1)
    return np.array(longest)


def _segment_starts(
    tree: RootedTree, longest: NDArray[np.intp], threshold: int
) -> NDArray[np.bool_]:
    """(N,) whether a point begins a segment: the root, and every long branch at a fork."""
    child = tree.order[1:]
    long = child[longest[child] > threshold]
    branches = np.bincount(tree.parent[long], minlength=len(tree.order))
    starts = np.zeros(len(tree.order), bool)
    starts[long[branches[tree.parent[long]] > 1]] = True
    starts[tree.order[0]] = True
    return starts


def _hierarchy(tree: RootedTree, starts: NDArray[np.bool_]) -> Hierarchy:
    """Segments numbered from the root on, each point in the segment that began above it last."""
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
