"""Judge the motion of an organ by the ends of a sample of its movers.

The ends are the (2, n, 3) positions of n movers in the first and in the second scan of an interval.
"""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from baker.geometry.graph import connected_knn_graph, geodesic_distances
from baker.geometry.neighbors import Points, point_spacing
from baker.interpolation.organ_shapes import Attachments
from baker.verdict.doubt import MIN_SHARE
from gclip import Interval, Motion
from gclip.evaluate import positions_on_curve
from traits.doubts import Doubt

# Beyond these thresholds the motion of an organ is doubtful (docs/method.md, "The verdict").
MAX_TORN_SHARE, MIN_ORDER_CORRELATION, MAX_DETACHMENT = 0.05, 0.5, 0.1
SAMPLE_SIZE, PARENT_SAMPLE_SIZE = 400, 2000  # number of movers that are examined
MIN_POINTS = 60  # of an organ in both scans, to be judged
NEIGHBORS, NEIGHBOR_DISTANCE = 6, 2.5  # most neighbours of a point; point spacings to them
# Neighbours in one scan are torn if their distance in the other is larger than both.
TORN_DISTANCE, TORN_SIZE = 8.0, 0.7  # in point spacings; in sizes of the organ, 1/5 of a rod
GRAPH_NEIGHBORS = 12  # of a point in the kNN graph for geodesic distances


def doubtful_motions(
    interval: Interval,
    attachments: tuple[Attachments, Attachments],
    names: Sequence[str],
    parents: Sequence[int | None],
) -> Iterator[Doubt]:
    """Yield a doubt about the motion of each large organ that is matched and moves wrongly.

    attachments: in the first and in the second scan. names, parents: of the organs, by track id.
    """
    stop = max((g.stop for g in interval.groups if g.motion is Motion.MOVE), default=0)
    tracks = np.asarray(interval.tracks[:stop])
    for track in sorted({pair.track for pair in interval.segments if pair.event == "match"}):
        movers = np.flatnonzero(tracks == track)
        if len(movers) < max(1, MIN_SHARE * stop):
            continue
        size = min(len(movers), SAMPLE_SIZE)
        sample: Any = movers[np.arange(size) * len(movers) // size]
        ends = np.stack([positions_on_curve(interval, sample, u) for u in (0.0, 1.0)])
        contacts = [side[track] for side in attachments if track in side]
        faults = [*motion_faults(ends.astype(float), contacts)]
        others = np.flatnonzero(tracks == parents[track])
        if faults and len(others):
            others = others[:: max(1, len(others) // PARENT_SAMPLE_SIZE)]
            faults.append(("{} comes off", detachment(interval, sample, others) / MAX_DETACHMENT))
        clause, strength = max(faults, key=lambda fault: fault[1], default=("", 0.0))
        if strength >= 1.0:
            what = clause.format(names[track])
            yield Doubt(interval.start, interval.end, track, what, strength)


def detachment(interval: Interval, organ: Any, parent: Any) -> float:
    """By how much the movers of an organ are farther from its parent at mid-interval, in sizes."""
    from scipy.spatial import cKDTree

    gaps = []
    for share in (0.5, 0.0, 1.0):
        points, others = (positions_on_curve(interval, side, share) for side in (organ, parent))
        gaps.append(float(cKDTree(others).query(points)[0].min()))
    return (gaps[0] - max(gaps[1:])) / max(float(np.sqrt(points.var(axis=0).sum())), 1e-30)


def motion_faults(ends: Points, attachments: Sequence[Points]) -> Iterator[tuple[str, float]]:
    """Yield possible faults of an organ's motion: a clause with {} for the organ, and a strength.

    A fault is doubtful from a strength of 1 on. An organ of fewer than `MIN_POINTS` has no faults.

    attachments: (c, 3) points by which the organ touches its parent, in none, one or both scans.
    """
    distinct = [np.unique(points, axis=0) for points in ends]
    if min(map(len, distinct)) < MIN_POINTS:
        return
    spacing, size = max(map(point_spacing, distinct)), float(np.sqrt(ends[1].var(axis=0).sum()))
    threshold = max(TORN_DISTANCE * spacing, TORN_SIZE * size)
    yield "{} tears", torn_share(ends, spacing, threshold) / MAX_TORN_SHARE
    if len(attachments) == 2:
        order = order_correlation(ends, attachments)
        parts = "the tip and the base" if order < 0 else "parts"
        yield f"{parts} of {{}} change places", (1.0 - order) / (1.0 - MIN_ORDER_CORRELATION)


def torn_share(ends: Points, spacing: float, threshold: float) -> float:
    """Share of the neighbours in one scan whose distance in the other exceeds the threshold.

    It is the larger share of both directions: neighbours may be separated, or brought together.
    """
    from scipy.spatial import cKDTree

    shares = [0.0]
    for points, moved in (ends, ends[::-1]):
        distance, neighbor = cKDTree(points).query(points, NEIGHBORS + 1)
        i, column = np.nonzero(distance[:, 1:] < NEIGHBOR_DISTANCE * spacing)
        moved_distance = np.linalg.norm(moved[i] - moved[neighbor[i, column + 1]], axis=1)
        shares += [float((moved_distance > threshold).mean())] if len(i) else []
    return max(shares)


def order_correlation(ends: Points, attachments: Sequence[Points]) -> float:
    """Spearman's rank correlation of geodesic distances from the attachment in both scans."""
    from scipy.spatial import cKDTree

    ranks = []
    for points, contact in zip(ends, attachments, strict=True):
        seeds = np.unique(cKDTree(points).query(contact)[1])
        distances = geodesic_distances(connected_knn_graph(points, GRAPH_NEIGHBORS), seeds)
        # Equivalent to scipy.stats.spearmanr, whose import takes a second.
        ranks.append(np.argsort(np.argsort(distances, kind="stable")))
    return float(np.asarray(np.corrcoef(ranks))[0, 1])
