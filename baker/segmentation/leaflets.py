"""The leaflets of an organ that has some: the leaves of a twig, the leaflets of a compound leaf.

One label may stand for a branch with all its leaves. A leaflet is a branch of the merge tree of the
geodesic distance from the attachment point: what has not yet met another one on the way down from
its tip. What is left, below the meeting points, is the stalk. A single blade has no leaflets: the
bumps of its margin are short.
"""

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import branches, connected_knn_graph, geodesic_distances

# docs/method.md, "Leaflets".
NEIGHBORS = 5  # of the kNN graph; more of them connect leaves that lie close by
MIN_LENGTH_IN_EDGES = 3.0  # median edges of the graph
MIN_LENGTH = 0.03  # share of the organ's longest geodesic distance
MIN_RELATIVE_LENGTH = 1 / 3  # of the leaflet that it meets
MIN_POINTS = 5
MAX_POINTS_SEARCHED = 2000  # of more points leaflets are told apart no better


def segment_leaflets(points: NDArray[np.floating], attachment: int) -> NDArray[np.intp]:
    """The leaflet that each point of an organ lies on.

    Parameters
    ----------
    points : (n, 3) float ndarray
    attachment : int
        The point where the organ is attached.

    Returns
    -------
    (n,) intp ndarray
        From 0 on; -1 on the stalk, and everywhere where no two leaflets meet.
    """
    from scipy.spatial import KDTree

    count = len(points)
    if count > MAX_POINTS_SEARCHED:
        sample = np.random.default_rng(0).permutation(count)[:MAX_POINTS_SEARCHED]
        sample[0] = attachment
        found = segment_leaflets(points[sample], 0)
        if found.max() >= 0:
            return found[KDTree(points[sample]).query(points)[1]]
    if count > MAX_POINTS_SEARCHED or count < 2 * MIN_POINTS or not np.ptp(points, axis=0).any():
        return np.full(count, -1)
    graph, _, _ = connected_knn_graph(points, NEIGHBORS)
    distance = geodesic_distances(graph, np.array([attachment]))
    min_length = max(
        MIN_LENGTH_IN_EDGES * float(np.median(graph.data)), MIN_LENGTH * float(distance.max())
    )
    return branches(distance, graph, min_length, MIN_RELATIVE_LENGTH, MIN_POINTS)
