"""The skeleton of a plant: level sets of the way from its base, hung into a tree.

The parts of each level set are the nodes of a Reeb graph, the plant's skeleton. Where leaves touch,
that graph has loops; they are cut, each point staying with the part that it was reached through. A
small loop is no touch of two organs but a hole in the scan, and is closed again.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.segmentation.voxel_sampling import EvenSample, section_width

HOLE = 3.0  # length of a loop that is but a hole, in stem diameters


@dataclass(frozen=True)
class LevelTree:
    """Parts of level sets, numbered from the base on: parents before their children.

    node:     (n,) the node of each point of the sample.
    parent:   of each node; -1 for the root, node 0.
    children: of each node.
    count:    (m,) points of each node.
    width:    (m,) of each node's section.
    reach:    (m,) way from the beginning of each node to the farthest tip beyond it.
    """

    node: NDArray[np.intp]
    parent: list[int]
    children: list[list[int]]
    count: NDArray[np.float64]
    width: NDArray[np.float64]
    reach: NDArray[np.float64]

    def gathered(self, values: NDArray[np.floating]) -> NDArray[np.float64]:
        """(m,) sums over each node and all nodes beyond it of (m,) values."""
        sums = np.array(values, np.float64)
        for node in range(len(self.parent) - 1, 0, -1):
            sums[self.parent[node]] += sums[node]
        return sums


def level_tree(sample: EvenSample) -> LevelTree:
    """Cut the sample into level sets of its distance from the base and hang them into a tree."""
    level = (sample.distance / sample.thickness).astype(np.intp)
    node, parent, depth = np.full(len(level), -1), list[int](), list[int]()
    entry = _entries(sample.before, level)
    for members in _parts(sample, level):
        here = int(level[members[0]])
        before = sample.before[entry[members]]
        source = np.where(before < 0, -1, node[before])
        for origin, own in _by_origin(members, source, parent, depth, here, sample):
            node[own] = len(parent)
            parent.append(origin)
            depth.append(here)
    return _measured(sample, node, parent)


def _entries(before: NDArray[np.intp], level: NDArray[np.intp]) -> NDArray[np.intp]:
    """(n,) the point through which the way to each point entered that point's level set."""
    inside = (before >= 0) & (level[before] == level)
    entry = np.where(inside, before, np.arange(len(before)))
    while True:
        further = entry[entry]
        if np.array_equal(further, entry):
            return entry
        entry = further


def _parts(sample: EvenSample, level: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """The connected parts of all level sets, from the base on."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    edges = sample.graph.tocoo()
    inside = level[edges.row] == level[edges.col]
    shape = edges.shape
    kept = coo_matrix((edges.data[inside], (edges.row[inside], edges.col[inside])), shape)
    _, part = connected_components(kept, directed=False)
    order = np.lexsort((part, level))
    return np.split(order, np.flatnonzero(np.diff(part[order])) + 1)


def _by_origin(
    members: NDArray[np.intp],
    source: NDArray[np.intp],
    parent: list[int],
    depth: list[int],
    level: int,
    sample: EvenSample,
) -> list[tuple[int, NDArray[np.intp]]]:
    """A part's points by the node that they were reached through, holes closed."""
    origins, counts = np.unique(source, return_counts=True)
    if len(origins) == 1:
        return [(int(origins[0]), members)]
    kept: dict[int, list[int]] = {}
    for origin in origins[np.argsort(-counts, kind="stable")].tolist():
        for other, joined in kept.items():
            loop = level - depth[_fork(parent, origin, other)]
            if loop * sample.thickness < HOLE * sample.diameter:
                joined.append(origin)
                break
        else:
            kept[origin] = [origin]
    return [(origin, members[np.isin(source, joined)]) for origin, joined in kept.items()]


def _fork(parent: list[int], one: int, other: int) -> int:
    """The last node that two nodes are both reached through; parents have smaller numbers."""
    while one != other:
        one, other = (parent[one], other) if one > other else (one, parent[other])
    return one


def _measured(sample: EvenSample, node: NDArray[np.intp], parent: list[int]) -> LevelTree:
    children: list[list[int]] = [[] for _ in parent]
    reach = np.full(len(parent), sample.thickness)
    for child in range(len(parent) - 1, 0, -1):
        children[parent[child]].insert(0, child)
        reach[parent[child]] = max(reach[parent[child]], reach[child] + sample.thickness)
    order = np.argsort(node, kind="stable")
    members = np.split(order, np.flatnonzero(np.diff(node[order])) + 1)
    width = np.array([section_width(sample.points[m], sample.distance[m]) for m in members])
    count = np.array([len(m) for m in members], np.float64)
    return LevelTree(node, parent, children, count, width, reach)
