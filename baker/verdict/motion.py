"""Measure how the organs of an interval move, on a sample of each organ's movers.

Lengths are in units of the spacing between the points of the sample.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import connected_knn_graph, geodesic_distances
from baker.geometry.neighbors import point_spacing
from gclip import Interval, Motion
from gclip.evaluate import positions_on_curve

Points = NDArray[np.floating]

SAMPLE_SIZE = 400  # movers of an organ
MIN_MOVERS = 60  # of an organ that is measured
MIN_SIZE = 4.0  # likewise, its root mean square size in point spacings
MIN_DISTINCT = 0.2  # likewise, its share of distinct points; new organs unfold from few points
PARAMETERS = (0.0, 0.25, 0.5, 0.75, 1.0)  # of the movers' curves, at which they are evaluated
NEIGHBORS = 6
NEIGHBOR_DISTANCE, TORN_DISTANCE = 2.5, 8.0  # in point spacings, of neighbours; of torn ones
TORN_SIZE = 0.7  # in sizes of the organ, torn neighbours are at least so far apart: 1/5 of a rod
GRAPH_NEIGHBORS = 12


@dataclass(frozen=True)
class SampledMotion:
    """The motion of one organ from the first to the second scan of an interval."""

    path: NDArray[np.float64]  # (5, n, 3) positions at `PARAMETERS`
    share: float  # of the interval's movers that belong to the organ

    @property
    def ends(self) -> tuple[Points, Points]:
        return self.path[0], self.path[-1]

    @cached_property
    def distinct(self) -> list[Points]:
        """The distinct points in both scans: several movers may start or end at one point."""
        return [np.unique(points, axis=0) for points in self.ends]

    @cached_property
    def spacing(self) -> float:
        """Median distance between nearest neighbours, in the scan where it is larger."""
        return max(map(point_spacing, self.distinct))

    @cached_property
    def sizes(self) -> NDArray[np.float64]:
        """(5,) root mean square distances of the points from their mean."""
        about = self.path - self.path.mean(axis=1, keepdims=True)
        return np.asarray(np.sqrt((about**2).sum(axis=2).mean(axis=1)))

    @property
    def is_measurable(self) -> bool:
        """Whether the organ is large enough in both scans to judge its motion."""
        count = self.path.shape[1]
        if count < MIN_MOVERS or min(map(len, self.distinct)) < MIN_DISTINCT * count:
            return False
        return bool(self.sizes[[0, -1]].min() >= MIN_SIZE * self.spacing)

    @cached_property
    def torn_share(self) -> float:
        """Share of the neighbouring points in one scan that are far apart in the other.

        It is the larger share of both directions: neighbours may be separated, or brought together.
        """
        from scipy.spatial import KDTree

        threshold = max(TORN_DISTANCE * self.spacing, TORN_SIZE * self.sizes[-1])
        shares = []
        for points, moved in (self.ends, self.ends[::-1]):
            distance, neighbor = KDTree(points).query(points, NEIGHBORS + 1)
            i, column = np.nonzero(distance[:, 1:] < NEIGHBOR_DISTANCE * self.spacing)
            moved_distance = np.linalg.norm(moved[i] - moved[neighbor[i, column + 1]], axis=1)
            shares.append(float((moved_distance > threshold).mean()) if len(i) else 0.0)
        return max(shares)

    @property
    def size_change(self) -> float:
        """How far the size between the scans leaves the range of their sizes, as a share of these.

        It is positive where the organ is larger between the scans, negative where it is smaller.
        """
        low, high = sorted(self.sizes[[0, -1]])
        shrunk, swollen = 1.0 - self.sizes.min() / low, self.sizes.max() / high - 1.0
        return float(swollen if swollen > shrunk else -shrunk)

    def order_correlation(self, attachments: Sequence[Points]) -> float:
        """Rank correlation (Spearman's) of geodesic distances from the attachment in both scans.

        attachments: for both scans, the (c, 3) points by which the organ touches its parent.
        """
        from scipy.spatial import KDTree

        ranks = []
        for points, contact in zip(self.ends, attachments, strict=True):
            seeds = np.unique(KDTree(points).query(contact)[1])
            graph = connected_knn_graph(points, GRAPH_NEIGHBORS)[0]
            # Equivalent to scipy.stats.spearmanr, whose import takes a second.
            distances = geodesic_distances(graph, seeds)
            ranks.append(np.argsort(np.argsort(distances, kind="stable")))
        return float(np.asarray(np.corrcoef(ranks))[0, 1])


def sampled_motions(interval: Interval) -> dict[int, SampledMotion]:
    """Evaluate a sample of each organ's movers; by track id, without organs that are lost."""
    stop = max((g.stop for g in interval.groups if g.motion is Motion.MOVE), default=0)
    tracks = np.asarray(interval.tracks[:stop])
    order = np.argsort(tracks, kind="stable")
    organs, first, count = np.unique(tracks[order], return_index=True, return_counts=True)
    sizes = np.minimum(count, SAMPLE_SIZE)
    sampled = [a + np.arange(n) * c // n for a, n, c in zip(first, sizes, count, strict=True)]
    movers: Any = order[np.concatenate(sampled)]
    paths = np.stack([positions_on_curve(interval, movers, u) for u in PARAMETERS]).astype(float)
    motions = map(SampledMotion, np.split(paths, np.cumsum(sizes)[:-1], axis=1), count / stop)
    return dict(zip(organs.tolist(), motions, strict=True))
