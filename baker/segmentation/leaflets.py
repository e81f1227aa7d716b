"""The limbs of an organ that has some: a twig's leaves, a compound leaf's leaflets.

One label may stand for a branch with all its leaves. Seen from their tips, limbs are what has not
yet met another one on the way to where the organ is attached. What is left, below the forks, is the
organ's stalk. A single blade has none: the bumps of its margin are short.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import connected_knn_graph, geodesic_distances
from baker.geometry.merge_tree import branches

NEIGHBORS = 5  # more tie leaves together that lie close by
LONG = 3.0  # median edges of the graph that a limb is long at least, ...
LONG_SHARE = 0.03  # ... and of the organ
BESIDE = 1 / 3  # as long as another one, else it is but a bump on it
FEWEST = 5  # points of a limb
MOST = 5000  # points to look at: with more of them limbs are no better told from one another


def limbs(points: NDArray[np.floating], foot: int) -> NDArray[np.intp]:
    """(n,) the limb of each of an organ's (n, 3) points, from 0 on; -1 on the stalk.

    foot: the point where the organ is attached.

    All -1 where no two limbs meet.
    """
    from scipy.spatial import KDTree

    count = len(points)
    if count <= MOST:
        return _limbs(points, foot)
    some = np.random.default_rng(0).permutation(count)[:MOST]
    some[0] = foot
    found = _limbs(points[some], 0)
    if found.max() < 0:
        return np.full(count, -1)
    return found[KDTree(points[some]).query(points)[1]]


def _limbs(points: NDArray[np.floating], foot: int) -> NDArray[np.intp]:
    if len(points) < 2 * FEWEST or not np.ptp(points, axis=0).any():
        return np.full(len(points), -1)
    graph, _, _ = connected_knn_graph(points, NEIGHBORS)
    distance = geodesic_distances(graph, np.array([foot]))
    longest = max(LONG * float(np.median(graph.data)), LONG_SHARE * float(distance.max()))
    return branches(distance, graph, longest, BESIDE, FEWEST)
