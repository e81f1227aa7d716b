"""How the organs of an interval move, judged from the movers alone: no true motion is known.

All of it is measured on a sample of each organ's movers, in distances between the sample's points.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import connected_knn_graph, geodesic_distances
from baker.geometry.neighbors import point_spacing
from gclip import Interval, Motion
from gclip.evaluate import positions_on_curve

Points = NDArray[np.floating]

SAMPLE_SIZE = 500  # movers of an organ
MIN_MOVERS = 60  # below which an organ is too small to tell
MIN_SIZE = 4.0  # likewise, root mean square size in distances between its points
MIN_DISTINCT = 0.2  # share of distinct points; fewer unfold from an attachment point
PARAMETERS = (0.0, 0.25, 0.5, 0.75, 1.0)  # at which the movers are seen
NEIGHBORS = 6
NEAR, TORN = 2.5, 8.0  # distances of neighbours, and of points that are neighbours no more
TORN_LENGTH = 0.2  # and they are as far apart as that share of the organ's length
GRAPH_NEIGHBORS = 12


def sampled_movers(interval: Interval) -> dict[int, NDArray[np.float64]]:
    """(5, n, 3) positions of movers of each organ at `PARAMETERS`, by track id; lost ones aside."""
    stop = max((g.stop for g in interval.groups if g.motion is Motion.MOVE), default=0)
    tracks = np.asarray(interval.tracks[:stop])
    order = np.argsort(tracks, kind="stable")
    found, first, count = np.unique(tracks[order], return_index=True, return_counts=True)
    sizes = np.minimum(count, SAMPLE_SIZE)
    even = [np.arange(n) * c // n for n, c in zip(sizes, count, strict=True)]
    movers: Any = order[np.concatenate([begin + e for begin, e in zip(first, even, strict=True)])]
    states = np.stack([positions_on_curve(interval, movers, u) for u in PARAMETERS]).astype(float)
    parts = np.split(states, np.cumsum(sizes)[:-1], axis=1)
    return {int(track): part for track, part in zip(found, parts, strict=True)}


def is_measurable(path: NDArray[np.float64]) -> bool:
    """Whether an organ, (5, n, 3), is large enough at both scans to tell how it moves."""
    if path.shape[1] < MIN_MOVERS:
        return False
    ends = [np.unique(path[k], axis=0) for k in (0, -1)]
    if min(map(len, ends)) < MIN_DISTINCT * path.shape[1]:
        return False
    return min(map(size, ends)) >= MIN_SIZE * max(map(point_spacing, ends))


def size(points: Points) -> float:
    """Root mean square distance of points from their mean."""
    return float(np.sqrt(((points - points.mean(axis=0)) ** 2).sum(axis=1).mean()))


def torn_share(path: NDArray[np.float64]) -> float:
    """Share of the pairs of neighbours at one scan that are far apart at the other; the larger one.

    An organ that is cut in two loses neighbours; one that comes together from two gains some.
    """
    from scipy.spatial import KDTree

    start, end = path[0], path[-1]
    spacing = max(point_spacing(np.unique(points, axis=0)) for points in (start, end))
    about = end - end.mean(axis=0)
    length = np.ptp(about @ np.linalg.svd(about, full_matrices=False)[2][0])
    far, shares = max(TORN * spacing, TORN_LENGTH * length), []
    for one, other in ((start, end), (end, start)):
        distance, neighbor = KDTree(one).query(one, NEIGHBORS + 1)
        i, column = np.nonzero(distance[:, 1:] < NEAR * spacing)
        apart = np.linalg.norm(other[i] - other[neighbor[i, column + 1]], axis=1)
        shares.append(float((apart > far).mean()) if len(i) else 0.0)
    return max(shares)


def order_kept(path: NDArray[np.float64], parent: NDArray[np.float64]) -> float:
    """Spearman's correlation of the points' distances along an organ from where it is attached.

    path, parent : (5, n, 3) and (5, m, 3). Of all points that touch the parent, the organ is
    attached at the two that are nearest to each other: attachment points move little.
    """
    from scipy.spatial import KDTree

    touching = []
    for points, others in ((path[0], parent[0]), (path[-1], parent[-1])):
        gap = KDTree(others).query(points)[0]
        margin = NEAR * point_spacing(np.unique(points, axis=0))
        touching.append(np.flatnonzero(gap <= max(margin, 1.5 * gap.min())))
    gap, nearest = KDTree(path[-1][touching[1]]).query(path[0][touching[0]])
    base = int(gap.argmin())
    bases = touching[0][base], touching[1][nearest[base]]
    along = [
        geodesic_distances(connected_knn_graph(points, GRAPH_NEIGHBORS)[0], np.array([seed]))
        for points, seed in zip((path[0], path[-1]), bases, strict=True)
    ]
    # The ranks here: importing scipy.stats takes a second.
    ranks = [np.argsort(np.argsort(distance, kind="stable")) for distance in along]
    return float(np.asarray(np.corrcoef(ranks))[0, 1])


def size_on_the_way(path: NDArray[np.float64]) -> float:
    """How far an organ's size leaves the range of its sizes at both scans, as a share of these.

    Above 0 where it is larger on the way, below 0 where it is smaller.
    """
    sizes = np.array([size(points) for points in path])
    low, high = sorted(sizes[[0, -1]])
    shrunk, swollen = 1.0 - sizes.min() / low, sizes.max() / high - 1.0
    return float(swollen if swollen > shrunk else -shrunk)
