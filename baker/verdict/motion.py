"""How the organs of an interval move, judged from the movers alone: no true motion is known.

All of it is measured on a sample of each organ's movers, in distances between the sample's points.
"""

from __future__ import annotations

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
MIN_MOVERS = 60  # below which an organ is too small to tell
MIN_SIZE = 4.0  # likewise, root mean square size in distances between its points
MIN_DISTINCT = 0.2  # share of distinct points; fewer unfold from an attachment point
PARAMETERS = (0.0, 0.25, 0.5, 0.75, 1.0)  # at which the movers are seen
NEIGHBORS = 6
NEAR, TORN = 2.5, 8.0  # distances of neighbours, and of points that are neighbours no more
TORN_LENGTH = 0.2  # and they are as far apart as that share of the organ's length
GRAPH_NEIGHBORS = 12


@dataclass(frozen=True)
class SampledMotion:
    """One organ's way from scan to scan."""

    path: NDArray[np.float64]  # (5, n, 3) at `PARAMETERS`

    @property
    def ends(self) -> tuple[Points, Points]:
        return self.path[0], self.path[-1]

    @cached_property
    def distinct(self) -> list[Points]:
        """The different points at both scans: several movers may share one."""
        return [np.unique(points, axis=0) for points in self.ends]

    @cached_property
    def spacings(self) -> list[float]:
        """Median distance between neighbours at both scans."""
        return [point_spacing(points) for points in self.distinct]

    @property
    def spacing(self) -> float:
        return max(self.spacings)

    @cached_property
    def sizes(self) -> NDArray[np.float64]:
        """(5,) root mean square distances of the points from their mean."""
        about = self.path - self.path.mean(axis=1, keepdims=True)
        return np.asarray(np.sqrt((about**2).sum(axis=2).mean(axis=1)))

    @property
    def is_measurable(self) -> bool:
        """Whether the organ is large enough at both scans to tell how it moves."""
        count = self.path.shape[1]
        if count < MIN_MOVERS:
            return False
        if min(map(len, self.distinct)) < MIN_DISTINCT * count:
            return False
        return bool(self.sizes[[0, -1]].min() >= MIN_SIZE * self.spacing)

    @cached_property
    def torn(self) -> float:
        """Share of the pairs of neighbours at one scan that are far apart at the other.

        The larger share: an organ that is cut loses neighbours, one that comes together gains some.
        """
        from scipy.spatial import KDTree

        start, end = self.ends
        about = end - end.mean(axis=0)
        length = np.ptp(about @ np.linalg.svd(about, full_matrices=False)[2][0])
        far, shares = max(TORN * self.spacing, TORN_LENGTH * length), []
        for one, other in ((start, end), (end, start)):
            distance, neighbor = KDTree(one).query(one, NEIGHBORS + 1)
            i, column = np.nonzero(distance[:, 1:] < NEAR * self.spacing)
            apart = np.linalg.norm(other[i] - other[neighbor[i, column + 1]], axis=1)
            shares.append(float((apart > far).mean()) if len(i) else 0.0)
        return max(shares)

    @property
    def size_change(self) -> float:
        """How far the size on the way leaves the range of both scans', as a share of these.

        Above 0 where the organ is larger on the way, below 0 where it is smaller.
        """
        low, high = sorted(self.sizes[[0, -1]])
        shrunk, swollen = 1.0 - self.sizes.min() / low, self.sizes.max() / high - 1.0
        return float(swollen if swollen > shrunk else -shrunk)

    def order_kept(self, parent: SampledMotion) -> float:
        """Spearman's correlation of the points' geodesic distances from where it is attached.

        Of all points that touch the parent at either scan, the organ is attached at the two that
        are nearest to each other: attachment points move little.
        """
        from scipy.spatial import KDTree

        touching = []
        for points, others, spacing in zip(self.ends, parent.ends, self.spacings, strict=True):
            gap = KDTree(others).query(points)[0]
            touching.append(np.flatnonzero(gap <= max(NEAR * spacing, 1.5 * gap.min())))
        start, end = (points[own] for points, own in zip(self.ends, touching, strict=True))
        gap, nearest = KDTree(end).query(start)
        base = int(gap.argmin())
        bases = touching[0][base], touching[1][nearest[base]]
        along = [
            geodesic_distances(connected_knn_graph(points, GRAPH_NEIGHBORS)[0], np.array([seed]))
            for points, seed in zip(self.ends, bases, strict=True)
        ]
        # The ranks here: importing scipy.stats takes a second.
        ranks = [np.argsort(np.argsort(distance, kind="stable")) for distance in along]
        return float(np.asarray(np.corrcoef(ranks))[0, 1])


def sampled_motions(interval: Interval) -> dict[int, SampledMotion]:
    """The motion of a sample of each organ's movers, by track id; lost organs aside."""
    stop = max((g.stop for g in interval.groups if g.motion is Motion.MOVE), default=0)
    tracks = np.asarray(interval.tracks[:stop])
    order = np.argsort(tracks, kind="stable")
    found, first, count = np.unique(tracks[order], return_index=True, return_counts=True)
    sizes = np.minimum(count, SAMPLE_SIZE)
    even = [np.arange(n) * c // n for n, c in zip(sizes, count, strict=True)]
    movers: Any = order[np.concatenate([begin + e for begin, e in zip(first, even, strict=True)])]
    states = np.stack([positions_on_curve(interval, movers, u) for u in PARAMETERS]).astype(float)
    parts = np.split(states, np.cumsum(sizes)[:-1], axis=1)
    return {int(track): SampledMotion(part) for track, part in zip(found, parts, strict=True)}
