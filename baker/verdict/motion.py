"""Measure how the organs of an interval move, on a sample of each organ's movers.

A path holds the (5, n, 3) positions of n movers at `PARAMETERS` of their curves, from the first to
the second scan of the interval. Lengths are in units of the spacing between these points.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import connected_knn_graph, geodesic_distances
from baker.geometry.neighbors import point_spacing
from baker.verdict.doubt import MIN_SHARE
from gclip import Interval, Motion
from gclip.evaluate import positions_on_curve

Points = NDArray[np.floating]

# Beyond these thresholds the motion of an organ is doubtful (docs/method.md, "The verdict").
MAX_TORN_SHARE, MIN_ORDER_CORRELATION, MAX_SIZE_CHANGE = 0.05, 0.5, 0.2
SAMPLE_SIZE = 400  # movers of an organ
MIN_MOVERS = 60  # of an organ that is measured
MIN_SIZE = 4.0  # likewise, its root mean square size in point spacings
MIN_DISTINCT = 0.2  # likewise, its share of distinct points; new organs unfold from few points
PARAMETERS = (0.0, 0.25, 0.5, 0.75, 1.0)  # of the movers' curves, at which they are evaluated
NEIGHBORS = 6
NEIGHBOR_DISTANCE, TORN_DISTANCE = 2.5, 8.0  # in point spacings, of neighbours; of torn ones
TORN_SIZE = 0.7  # in sizes of the organ, torn neighbours are at least so far apart: 1/5 of a rod
GRAPH_NEIGHBORS = 12


def sampled_paths(interval: Interval) -> dict[int, Points]:
    """Sample the movers of each large organ; track id -> path, without organs that are lost."""
    stop = max((g.stop for g in interval.groups if g.motion is Motion.MOVE), default=0)
    tracks, paths = np.asarray(interval.tracks[:stop]), {}
    for track in np.unique(tracks).tolist():
        movers = np.flatnonzero(tracks == track)
        if len(movers) >= MIN_SHARE * stop:
            size = min(len(movers), SAMPLE_SIZE)
            sample = movers[np.arange(size) * len(movers) // size]
            path = np.stack([positions_on_curve(interval, sample, u) for u in PARAMETERS])
            paths[track] = path.astype(float)
    return paths


def motion_faults(path: Points, attachments: Sequence[Points]) -> Iterator[tuple[str, float]]:
    """Yield possible faults of an organ's motion: a clause with {} for the organ, and a strength.

    attachments: (c, 3) the points by which the organ touches its parent, in none or both scans. A
    strength of 1 is just doubtful. Organs that are too small, or flat points, have no faults.
    """
    distinct = [np.unique(points, axis=0) for points in path[[0, -1]]]
    count = path.shape[1]
    if count < MIN_MOVERS or min(map(len, distinct)) < MIN_DISTINCT * count:
        return
    spacing = max(map(point_spacing, distinct))
    about = path - path.mean(axis=1, keepdims=True)
    sizes = np.sqrt((about**2).sum(axis=2).mean(axis=1))  # (5,) root mean square sizes
    low, high = sorted(sizes[[0, -1]])
    if low < MIN_SIZE * spacing:
        return
    threshold = max(TORN_DISTANCE * spacing, TORN_SIZE * sizes[-1])
    yield "{} tears", torn_share(path, spacing, threshold) / MAX_TORN_SHARE
    shrinkage, growth = 1.0 - sizes.min() / low, sizes.max() / high - 1.0
    verb = "swells" if growth > shrinkage else "shrinks"
    yield f"{{}} {verb} between the scans", max(shrinkage, growth) / MAX_SIZE_CHANGE
    if len(attachments) == 2:
        order = order_correlation(path, attachments)
        parts = "the tip and the base" if order < 0 else "parts"
        yield f"{parts} of {{}} change places", (1.0 - order) / (1.0 - MIN_ORDER_CORRELATION)


def torn_share(path: Points, spacing: float, threshold: float) -> float:
    """Share of the neighbouring points in one scan that are far apart in the other.

    It is the larger share of both directions: neighbours may be separated, or brought together.
    """
    from scipy.spatial import KDTree

    shares = [0.0]
    for points, moved in (path[[0, -1]], path[[-1, 0]]):
        distance, neighbor = KDTree(points).query(points, NEIGHBORS + 1)
        i, column = np.nonzero(distance[:, 1:] < NEIGHBOR_DISTANCE * spacing)
        moved_distance = np.linalg.norm(moved[i] - moved[neighbor[i, column + 1]], axis=1)
        shares += [float((moved_distance > threshold).mean())] if len(i) else []
    return max(shares)


def order_correlation(path: Points, attachments: Sequence[Points]) -> float:
    """Rank correlation (Spearman's) of geodesic distances from the attachment in both scans."""
    from scipy.spatial import KDTree

    ranks = []
    for points, contact in zip(path[[0, -1]], attachments, strict=True):
        seeds = np.unique(KDTree(points).query(contact)[1])
        graph = connected_knn_graph(points, GRAPH_NEIGHBORS)[0]
        # Equivalent to scipy.stats.spearmanr, whose import takes a second.
        distances = geodesic_distances(graph, seeds)
        ranks.append(np.argsort(np.argsort(distances, kind="stable")))
    return float(np.asarray(np.corrcoef(ranks))[0, 1])
