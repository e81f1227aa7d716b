"""The spanning tree of a point cloud: the skeleton that thin structures are segmented along."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

SHORTEST = np.finfo(np.float64).tiny  # scipy's graphs drop edges of weight zero


@dataclass(frozen=True)
class RootedTree:
    """A spanning tree of N points, its edges directed away from the root.

    order:   (N,) points from the root on, parents before their children (breadth first).
    parent:  (N,) each point's predecessor, -1 for the root.
    bridges: how many gaps between parts of the cloud had to be bridged, `widest` the widest one.
    """

    order: NDArray[np.intp]
    parent: NDArray[np.intp]
    bridges: int
    widest: float


def spanning_tree(points: NDArray[np.floating], root: int, neighbors: int = 15) -> RootedTree:
    """Minimum spanning tree of the k-nearest-neighbour graph (section 3.2.2), rooted.

    Where the graph falls into parts they are joined by their shortest gaps (Borůvka's algorithm).
    """
    from scipy.sparse.csgraph import breadth_first_order
    from scipy.sparse.csgraph import minimum_spanning_tree as minimum_tree

    graph, bridges, widest = connected_graph(points, neighbors)
    order, parent = breadth_first_order(minimum_tree(graph), root, directed=False)
    parent[root] = -1
    return RootedTree(order.astype(np.intp), parent.astype(np.intp), bridges, widest)


def connected_graph(points: NDArray[np.floating], neighbors: int) -> tuple[csr_matrix, int, float]:
    """The k-nearest-neighbour graph of (N, 3) points with its gaps bridged.

    Returns undirected edges weighted by their lengths, each once, in the matrix's upper half; how
    many gaps had to be bridged, and the widest of them.
    """
    from scipy.sparse.csgraph import connected_components

    graph = _neighbor_graph(points, neighbors)
    parts = connected_components(graph, directed=False)
    bridges, widest = parts[0] - 1, 0.0
    while parts[0] > 1:
        joined, gaps = _bridges(points, *parts)
        widest = max(widest, float(gaps.max()))
        graph = graph + joined
        parts = connected_components(graph, directed=False)
    return graph, bridges, widest


def _neighbor_graph(points: NDArray[np.floating], neighbors: int) -> csr_matrix:
    from scipy.spatial import cKDTree

    count = len(points)
    k = min(neighbors + 1, count)
    distances, nearest = cKDTree(points).query(points, k=k)
    rows = np.repeat(np.arange(count), k)
    return _graph(rows, np.reshape(nearest, -1), np.reshape(distances, -1), count)


def _graph(
    rows: NDArray[np.intp], columns: NDArray[np.intp], lengths: NDArray[np.floating], count: int
) -> csr_matrix:
    """Undirected edges as a sparse matrix, each once, in its upper half."""
    from scipy.sparse import coo_matrix

    a, b = np.minimum(rows, columns), np.maximum(rows, columns)
    edges, first = np.unique(a * count + b, return_index=True)
    proper = edges // count != edges % count
    edges, first = edges[proper], first[proper]
    weights = np.maximum(lengths[first], SHORTEST)
    return coo_matrix((weights, (edges // count, edges % count)), (count, count)).tocsr()


def _bridges(
    points: NDArray[np.floating], parts: int, part: NDArray[np.integer]
) -> tuple[csr_matrix, NDArray[np.floating]]:
    """The shortest edge out of each part, and the lengths of these edges.

    Any two parts' numbers differ in some bit: so the nearest foreign point of each point is found
    with one pair of trees for every bit, however many parts there are.
    """
    count = len(points)
    distance, foreign = np.full(count, np.inf), np.zeros(count, np.intp)
    for bit in range(int(parts - 1).bit_length()):
        zero, one = (np.flatnonzero((part >> bit & 1) == value) for value in (0, 1))
        for here, there in ((zero, one), (one, zero)):
            _keep_nearer(points, here, there, distance, foreign)
    by_part = np.lexsort((distance, part))
    best = by_part[np.unique(part[by_part], return_index=True)[1]]
    return _graph(best, foreign[best], distance[best], count), distance[best]


def _keep_nearer(
    points: NDArray[np.floating],
    here: NDArray[np.intp],
    there: NDArray[np.intp],
    distance: NDArray[np.floating],
    foreign: NDArray[np.intp],
) -> None:
    from scipy.spatial import cKDTree

    found, index = cKDTree(points[there]).query(points[here])
    nearer = found < distance[here]
    distance[here[nearer]] = found[nearer]
    foreign[here[nearer]] = there[index[nearer]]
