"""Segment an organ into leaflets: the leaves of a twig, or the leaflets of a compound leaf.

One label may be that of a branch with all its leaves. A leaflet is a branch of the merge tree of
the geodesic distance from the attachment point; the points nearer to the attachment point than all
merges are the stalk. A single blade has no leaflets, since the branches at its margin are short.
"""

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import branches, connected_knn_graph, geodesic_distances

# docs/method.md, "Leaflets".
NEIGHBORS = 5  # of the kNN graph; more neighbours would connect leaves that are close together
MIN_LENGTH_IN_EDGES = 3.0  # of a leaflet, in median edge lengths of the graph
MIN_LENGTH = 0.03  # of a leaflet, as a share of the organ's longest geodesic distance
MIN_RELATIVE_LENGTH = 1 / 3  # of a leaflet, as a share of the leaflet that it merges with
MIN_POINTS = 5  # of a leaflet
MAX_POINTS_SEARCHED = 2000  # of the organ; more points don't improve the segmentation


def segment_leaflets(points: NDArray[np.floating], attachment: int) -> NDArray[np.intp]:
    """Segment the (n, 3) points of an organ into leaflets.

    attachment: index of the attachment point. Returns the (n,) leaflet of each point, from 0 on;
    -1 on the stalk, and for all points if there are not at least two leaflets.
    """
    from scipy.spatial import cKDTree

    count = len(points)
    if count > MAX_POINTS_SEARCHED:
        sample = np.random.default_rng(0).permutation(count)[:MAX_POINTS_SEARCHED]
        sample[0] = attachment
        leaflet = segment_leaflets(points[sample], 0)
        if leaflet.max() >= 0:
            return leaflet[cKDTree(points[sample]).query(points)[1]]
    if count > MAX_POINTS_SEARCHED or count < 2 * MIN_POINTS or not np.ptp(points, axis=0).any():
        return np.full(count, -1)
    graph = connected_knn_graph(points, NEIGHBORS)
    distance = geodesic_distances(graph, np.array([attachment]))
    min_length = max(
        MIN_LENGTH_IN_EDGES * float(np.median(graph.data)), MIN_LENGTH * float(distance.max())
    )
    return branches(distance, graph, min_length, MIN_RELATIVE_LENGTH, MIN_POINTS)
