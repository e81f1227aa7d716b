"""How the organs of an interval move, judged from the movers alone: no true motion is known.

All of it is measured on a sample of each organ's movers, in distances between the sample's points.
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
MIN_MOVERS = 60  # below which an organ is too small to tell
MIN_SIZE = 4.0  # likewise, root mean square size in distances between its points
MIN_DISTINCT = 0.2  # share of distinct points; fewer unfold from an attachment point
PARAMETERS = (0.0, 0.25, 0.5, 0.75, 1.0)  # at which the movers are seen
NEIGHBORS = 6
NEAR, TORN = 2.5, 8.0  # distances of neighbours, and of points that are neighbours no more
TORN_SIZE = 0.7  # and they are as far apart as that times the organ's size: a fifth of a rod
GRAPH_NEIGHBORS = 12


@dataclass(frozen=True)
class SampledMotion:
    """One organ's way from scan to scan."""

    path: NDArray[np.float64]  # (5, n, 3) at `PARAMETERS`
    share: float  # of the interval's movers that are the organ's

    @property
    def ends(self) -> tuple[Points, Points]:
        return self.path[0], self.path[-1]

    @cached_property
    def distinct(self) -> list[Points]:
        """The different points at both scans: several movers may share one."""
        return [np.unique(points, axis=0) for points in self.ends]

    @cached_property
    def spacing(self) -> float:
        """Median distance between neighbours, at the scan where it is larger."""
        return max(map(point_spacing, self.distinct))

    @cached_property
    def sizes(self) -> NDArray[np.float64]:
        """(5,) root mean square distances of the points from their mean."""
        about = self.path - self.path.mean(axis=1, keepdims=True)
        return np.asarray(np.sqrt((about**2).sum(axis=2).mean(axis=1)))

    @property
    def is_measurable(self) -> bool:
        """Whether the organ is large enough at both scans to tell how it moves."""
        count = self.path.shape[1]
        if count < MIN_MOVERS or min(map(len, self.distinct)) < MIN_DISTINCT * count:
            return False
        return bool(self.sizes[[0, -1]].min() >= MIN_SIZE * self.spacing)

    @cached_property
    def torn(self) -> float:
        """Share of the pairs of neighbours at one scan that are far apart at the other.

        The larger share: an organ that is cut loses neighbours, one that comes together gains some.
        """
        from scipy.spatial import KDTree

        far, shares = max(TORN * self.spacing, TORN_SIZE * self.sizes[-1]), []
        for one, other in (self.ends, self.ends[::-1]):
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

    def order_kept(self, attachments: Sequence[Points]) -> float:
        """Spearman's correlation of the points' geodesic distances from the attachment.

        attachments: (c, 3), the points by which the organ touches its parent at both scans.
        """
        from scipy.spatial import KDTree

        ranks = []
        for points, contact in zip(self.ends, attachments, strict=True):
            seeds = np.unique(KDTree(points).query(contact)[1])
            graph = connected_knn_graph(points, GRAPH_NEIGHBORS)[0]
            # Ranked here: importing scipy.stats takes a second.
            along = geodesic_distances(graph, seeds)
            ranks.append(np.argsort(np.argsort(along, kind="stable")))
        return float(np.asarray(np.corrcoef(ranks))[0, 1])


def sampled_motions(interval: Interval) -> dict[int, SampledMotion]:
    """The motion of a sample of each organ's movers, by track id; lost organs aside."""
    stop = max((g.stop for g in interval.groups if g.motion is Motion.MOVE), default=0)
    tracks = np.asarray(interval.tracks[:stop])
    order = np.argsort(tracks, kind="stable")
    names, first, count = np.unique(tracks[order], return_index=True, return_counts=True)
    sizes = np.minimum(count, SAMPLE_SIZE)
    even = [np.arange(n) * c // n for n, c in zip(sizes, count, strict=True)]
    movers: Any = order[np.concatenate([begin + e for begin, e in zip(first, even, strict=True)])]
    states = np.stack([positions_on_curve(interval, movers, u) for u in PARAMETERS]).astype(float)
    parts = zip(np.split(states, np.cumsum(sizes)[:-1], axis=1), count / stop, strict=True)
    return {int(organ): SampledMotion(*part) for organ, part in zip(names, parts, strict=True)}
