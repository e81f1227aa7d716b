"""The kNN graph of a point cloud: connected, its spanning tree, geodesic distances, merge trees."""

from dataclasses import dataclass
from itertools import permutations
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import Neighbors, nearest_neighbors

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

Points = NDArray[np.floating]

MIN_LENGTH = float(np.finfo(np.float64).tiny)  # sparse sums drop edges of weight zero


@dataclass(frozen=True)
class RootedTree:
    """A spanning tree of N points, its edges directed away from the root."""

    order: NDArray[np.intp]  # (N,), from the root on, parents before their children (breadth first)
    parent: NDArray[np.intp]  # (N,), each point's predecessor, -1 for the root
    bridges: int  # gaps between parts of the cloud that were bridged
    widest: float  # length of the longest of them


def spanning_tree(
    points: Points, root: int, k: int = 15, neighbors: Neighbors | None = None
) -> RootedTree:
    """Minimum spanning tree of the connected kNN graph, rooted (section 3.2.2).

    Parameters
    ----------
    points, root : (N, 3) float, index of the point at the root
    k, neighbors : int, Neighbors, optional
        As of `connected_knn_graph`.
    """
    from scipy.sparse.csgraph import breadth_first_order, minimum_spanning_tree

    graph, bridges, widest = connected_knn_graph(points, k, neighbors)
    order, parent = breadth_first_order(minimum_spanning_tree(graph), root, directed=False)
    parent[root] = -1
    return RootedTree(order.astype(np.intp), parent.astype(np.intp), bridges, widest)


def knn_graph(neighbors: Neighbors) -> "csr_matrix":
    """The kNN graph, (N, N): an edge from each point to each neighbor, weighted by its length.

    It is not symmetric; ``scipy.sparse.csgraph`` takes it as undirected with ``directed=False``.
    """
    from scipy.sparse import csr_matrix

    count, k = neighbors.indices.shape
    lengths = np.maximum(neighbors.distances.astype(np.float64), MIN_LENGTH)
    begins = np.arange(0, count * k + 1, k) if k else np.zeros(count + 1, np.intp)
    return csr_matrix((lengths.ravel(), neighbors.indices.ravel(), begins), (count, count))


def connected_knn_graph(
    points: Points, k: int, neighbors: Neighbors | None = None
) -> tuple["csr_matrix", int, float]:
    """The kNN graph, its components joined by their shortest gaps (Borůvka's algorithm).

    Parameters
    ----------
    points, k : (N, 3) float, neighbours of each point
    neighbors : Neighbors, optional
        Of the points, where they are known; they are queried where these are fewer than k.

    Returns
    -------
    graph : (N, N) csr_matrix, as of `knn_graph`
    bridges, widest : int, float
        Edges added, and the length of the longest of these.
    """
    from scipy.sparse.csgraph import connected_components

    if neighbors is None or neighbors.indices.shape[1] < min(k, len(points) - 1):
        neighbors = nearest_neighbors(points, k)
    graph = knn_graph(neighbors.first(k))
    count, component = connected_components(graph, directed=False)
    bridges, widest = count - 1, 0.0
    while count > 1:
        joined, gaps = _shortest_bridges(points, count, component)
        widest = max(widest, float(gaps.max()))
        graph = graph + joined
        count, component = connected_components(graph, directed=False)
    return graph, bridges, widest


def geodesic_distances(
    graph: "csr_matrix", seeds: NDArray[np.integer], offsets: NDArray[np.floating] | None = None
) -> NDArray[np.float64]:
    """Lengths of the shortest paths along an undirected graph from the nearest seed.

    Parameters
    ----------
    graph, seeds : (N, N) csr_matrix, (s,) int
    offsets : (s,) float, optional
        Distances at the seeds, not negative; 0 by default.

    Returns
    -------
    (N,) float64, infinite where no path leads.
    """
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import dijkstra

    if offsets is None:
        return np.asarray(dijkstra(graph, directed=False, indices=seeds, min_only=True))
    # One more node, from which each seed is as far as its offset.
    count = graph.shape[0]
    lengths = np.concatenate([graph.data, np.maximum(offsets, MIN_LENGTH)])
    columns = np.concatenate([graph.indices, seeds])
    begins = np.append(graph.indptr, len(lengths))
    with_source = csr_matrix((lengths, columns, begins), (count + 1, count + 1))
    return np.asarray(dijkstra(with_source, directed=False, indices=count))[:count]


def chain_ends(following: NDArray[np.intp]) -> NDArray[np.intp]:
    """(n,) where each of n items comes to when it follows to the next one until that is itself."""
    while True:
        further = following[following]
        if np.array_equal(further, following):
            return following
        following = further


def branches(
    height: NDArray[np.floating],
    graph: "csr_matrix",
    min_length: float,
    min_share: float = 0.0,
    min_points: int = 1,
) -> NDArray[np.intp]:
    """Number the branches of the merge tree of a height on a graph, those of its superlevel sets.

    The connected components of all that is above a level grow as the level falls. Where two of them
    meet, both are complete branches, unless the lower one is but a bump on the other: its rise
    above the meeting point, its persistence, is too small.

    Parameters
    ----------
    height, graph : (N,) float, (N, N) sparse matrix with undirected edges at its non-zeros
    min_length, min_share : float
        Persistence of a branch, at least: its length, and its share of that of the branch it
        meets, if that has met none so far.
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


def _shortest_bridges(
    points: Points, components: int, component: NDArray[np.integer]
) -> tuple["csr_matrix", NDArray[np.floating]]:
    """The shortest edge out of each component, and the lengths of these edges.

    Any two components' numbers differ in some bit: so the nearest foreign point of each point is
    found with one pair of trees for every bit, however many components there are.
    """
    from scipy.sparse import coo_matrix
    from scipy.spatial import KDTree

    count = len(points)
    distance, foreign = np.full(count, np.inf), np.zeros(count, np.intp)
    for bit in range(int(components - 1).bit_length()):
        sides = [np.flatnonzero((component >> bit & 1) == value) for value in (0, 1)]
        for source, target in permutations(sides):
            found, index = KDTree(points[target]).query(points[source])
            nearer = found < distance[source]
            distance[source[nearer]] = found[nearer]
            foreign[source[nearer]] = target[index[nearer]]
    by_component = np.lexsort((distance, component))
    best = by_component[np.unique(component[by_component], return_index=True)[1]]
    # Two components may have chosen the same edge: it is entered once.
    edges = np.unique(np.sort(np.stack([best, foreign[best]]), axis=0), axis=1)
    lengths = np.linalg.norm(np.subtract(*points[edges].astype(np.float64)), axis=1)
    weights = np.maximum(lengths, MIN_LENGTH)
    return coo_matrix((weights, tuple(edges)), (count, count)).tocsr(), lengths
