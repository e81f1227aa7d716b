"""The connected kNN graph of a point cloud, its geodesics and merge trees; chains and paths."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import Neighbors, Points, nearest_neighbors

Graph = Any  # (N, N) scipy.sparse.csr_matrix
Gaps = Mapping[tuple[int, int], float]
"""(label, label) of adjacent segments, in either order -> distance in point spacings."""

MIN_LENGTH = float(np.finfo(np.float64).tiny)  # of an edge; sparse sums drop those of weight 0


def knn_graph(neighbors: Neighbors) -> Graph:
    """The (N, N) kNN graph: an edge from each point to its neighbours, weighted by length.

    It is not symmetric; use it with ``directed=False`` in ``scipy.sparse.csgraph``.
    """
    from scipy.sparse import csr_matrix

    count, k = neighbors.indices.shape
    lengths = np.maximum(neighbors.distances.astype(np.float64), MIN_LENGTH)
    begins = np.arange(0, count * k + 1, k) if k else np.zeros(count + 1, np.intp)
    return csr_matrix((lengths.ravel(), neighbors.indices.ravel(), begins), (count, count))


def connected_knn_graph(
    points: Points, k: int, neighbors: Neighbors | None = None, mutual: bool = False
) -> Graph:
    """The kNN graph, its components joined by their shortest gaps (Borůvka's algorithm).

    Parameters
    ----------
    points : (N, 3) float
    k : int
        Number of neighbours of each point.
    neighbors : Neighbors, optional
        Used instead of a query if there are at least k.
    mutual : bool
        Whether to keep only edges of points that are neighbours of each other. Where surfaces lie
        close together, fewer edges lead from one to the other.

    Returns
    -------
    (N, N) csr_matrix
        As `knn_graph` returns it, with the edges added.
    """
    from scipy.sparse.csgraph import connected_components

    if neighbors is None or neighbors.indices.shape[1] < min(k, len(points) - 1):
        neighbors = nearest_neighbors(points, k)
    graph = knn_graph(neighbors.first(k))
    if mutual:
        graph = graph.minimum(graph.T)
    while (components := connected_components(graph, directed=False))[0] > 1:
        graph = graph + _shortest_bridges(points, *components)
    return graph


def segment_gaps(
    points: Points, labels: NDArray[np.integer], neighbors: Neighbors | None = None
) -> Gaps:
    """Find the segments that are adjacent in the kNN graph, and the gaps between them.

    If that does not connect all segments, the connected kNN graph is taken.

    Returns the length of the shortest edge between any two adjacent segments of (N, 3) points, in
    point spacings. All segments are connected, directly or by others.
    """
    neighbors = neighbors or nearest_neighbors(points)
    distinct, segment = np.unique(labels, return_inverse=True)
    row, column = np.nonzero(segment[neighbors.indices] != segment[:, None])
    ends = segment[np.stack([row, neighbors.indices[row, column]])]
    lengths = neighbors.distances[row, column].astype(np.float64)
    count = len(distinct)
    if edge_components(ends, count).any():
        edges = connected_knn_graph(points, neighbors.indices.shape[1], neighbors).tocoo()
        ends, lengths = segment[np.stack([edges.row, edges.col])], edges.data
    is_between = ends[0] != ends[1]
    ends, lengths = np.sort(ends[:, is_between], axis=0), lengths[is_between]
    pairs, number = np.unique(ends[0] * count + ends[1], return_inverse=True)
    gaps = np.full(len(pairs), np.inf)
    np.minimum.at(gaps, number, lengths / max(neighbors.spacing, MIN_LENGTH))
    first, second = (distinct[side].tolist() for side in np.divmod(pairs, count))
    adjacent = dict(zip(zip(first, second, strict=True), gaps.tolist(), strict=True))
    return adjacent | {(b, a): gap for (a, b), gap in adjacent.items()}


def edge_components(edges: NDArray[np.integer], count: int) -> NDArray[np.int32]:
    """(count,) connected component of each node, from 0 on, by (2, E) undirected edges."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    graph = coo_matrix((np.ones(edges.shape[1]), edges), (count, count))
    return connected_components(graph, directed=False)[1]


def geodesic_distances(
    graph: Graph, seeds: NDArray[np.integer], offsets: NDArray[np.floating] | None = None
) -> NDArray[np.float64]:
    """Geodesic distances from the nearest seed, the shortest paths along an undirected graph.

    graph, seeds: (N, N) csr_matrix, (s,) int. offsets: (s,) distances at the seeds, by default 0.
    Returns (N,) distances, infinite where there is no path.
    """
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import dijkstra

    if offsets is None:
        return np.asarray(dijkstra(graph, directed=False, indices=seeds, min_only=True))
    # A source node is added, whose distance to each seed is the seed's offset.
    count = graph.shape[0]
    lengths = np.concatenate([graph.data, np.maximum(offsets, MIN_LENGTH)])
    columns = np.concatenate([graph.indices, seeds])
    begins = np.append(graph.indptr, len(lengths))
    with_source = csr_matrix((lengths, columns, begins), (count + 1, count + 1))
    return np.asarray(dijkstra(with_source, directed=False, indices=count))[:count]


def chain_ends(following: NDArray[np.intp]) -> NDArray[np.intp]:
    """(n,) last item of each item's chain, by pointer jumping.

    following: (n,) the item after each item, which is the item itself at the end of a chain.
    """
    while True:
        jumped = following[following]
        if np.array_equal(jumped, following):
            return following
        following = jumped


def branches(
    height: NDArray[np.floating],
    graph: Graph,
    min_length: float,
    min_share: float = 0.0,
    min_points: int = 1,
) -> NDArray[np.intp]:
    """Number the branches of the merge tree of the superlevel sets of a height on a graph.

    The connected components above a level grow as the level falls. Where two of them merge, both
    are complete branches, unless the persistence of the lower one, its height above the merge, is
    too small; then it becomes part of the other one.

    Parameters
    ----------
    height : (N,) float
    graph : (N, N) sparse matrix
        With undirected edges at its non-zeros.
    min_length, min_share : float
        Least persistence of a branch: absolute, and relative to that of the branch it merges with,
        if that one has not merged before.
    min_points : int
        Least number of points of a branch.

    Returns
    -------
    (N,) intp
        The branch of each point, from 0 on; -1 below all merges.

    References
    ----------
    Edelsbrunner, Letscher, Zomorodian: Topological persistence and simplification (2002).
    """
    # Points are ranked from the highest down: the lower end of an edge has the greater rank.
    count, descending = len(height), np.argsort(-height, kind="stable")
    rank = np.empty(count, np.intp)
    rank[descending] = np.arange(count)
    edges = graph.tocoo()
    upper, lower = np.sort(rank[np.stack([edges.row, edges.col])], axis=0)
    uphill = np.arange(count)
    np.minimum.at(uphill, lower, upper)
    peak = chain_ends(uphill)
    # Two components merge at the highest edge between them, the pass of their peaks.
    passes = np.flatnonzero(peak[upper] != peak[lower])
    passes = passes[np.argsort(lower[passes], kind="stable")]
    sides = np.sort(peak[np.stack([upper[passes], lower[passes]])], axis=0)
    first = np.sort(np.unique(sides[0] * count + sides[1], return_index=True)[1])
    component = np.arange(count)  # of each peak, identified by its highest peak
    has_merged = np.zeros(count, bool)
    branch, branch_count = np.full(count, -1, np.intp), 0
    for *pair, level in zip(*sides[:, first], lower[passes[first]], strict=True):
        high, low = np.sort(component[pair])
        if high == low:
            continue
        above_level = component[peak[: level + 1]]
        length, other_length = height[descending[[low, high]]] - height[descending[level]]
        is_long = length >= min_length and (has_merged[high] or length >= min_share * other_length)
        if has_merged[low] or (is_long and (above_level == low).sum() >= min_points):
            for side in (high, low):
                if not has_merged[side]:
                    branch[: level + 1][above_level == side] = branch_count
                    branch_count += 1
            has_merged[[high, low]] = True
        component[component == low] = high
    return branch[rank]


def _shortest_bridges(points: Points, components: int, component: NDArray[np.integer]) -> Graph:
    """The shortest edge out of each component.

    The numbers of any two components differ in some bit, so the nearest point in another component
    is found with one pair of KD-trees for each bit.
    """
    from scipy.sparse import coo_matrix
    from scipy.spatial import cKDTree

    count = len(points)
    distance, foreign = np.full(count, np.inf), np.zeros(count, np.intp)
    for bit in range(int(components - 1).bit_length()):
        for value in (0, 1):
            is_source = (component >> bit & 1) == value
            source, target = np.flatnonzero(is_source), np.flatnonzero(~is_source)
            to_target, index = cKDTree(points[target]).query(points[source])
            is_nearer = to_target < distance[source]
            distance[source[is_nearer]] = to_target[is_nearer]
            foreign[source[is_nearer]] = target[index[is_nearer]]
    by_component = np.lexsort((distance, component))
    best = by_component[np.unique(component[by_component], return_index=True)[1]]
    # Two components may have the same shortest edge, which is added once.
    edges = np.unique(np.sort(np.stack([best, foreign[best]]), axis=0), axis=1)
    lengths = np.linalg.norm(np.subtract(*points[edges].astype(np.float64)), axis=1)
    return coo_matrix((np.maximum(lengths, MIN_LENGTH), tuple(edges)), (count, count)).tocsr()


def best_path(scores: Iterable[NDArray[np.float64]]) -> list[int]:
    """The candidates of largest total score, one for each step (Viterbi 1967).

    scores: for each two successive steps the (n, m) scores of their pairs of candidates. Of equal
    paths, the one with the first candidates is chosen.
    """
    total, best_before = np.zeros(1), []
    for pairs in scores:
        totals = total[:, None] + pairs
        best_before.append(totals.argmax(axis=0))
        total = totals.max(axis=0)
    path = [int(total.argmax())]
    for best in reversed(best_before):
        path.append(int(best[path[-1]]))
    return path[::-1]
