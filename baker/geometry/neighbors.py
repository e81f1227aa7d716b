"""The k nearest neighbours of every point of a cloud, and what is read off them.

One query a scan answers for point spacing, outliers, the surface, label cleaning, segment adjacency
and graphs; none of them changes when the scan is moved rigidly.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gclip.morton import morton_order

NEIGHBORS = 10  # enough for a point at the border of a segment to see the next segment
NEIGHBORS_FOR_REACH = 8  # a point's reach is the distance to its 8th neighbour
OUTLIER_RATIO = 10.0  # an outlier reaches so many times as far as the median point
POINTS_AT_ONCE = 10_000  # whose neighbourhoods are looked at together
MAX_GAP = 3.0  # between segments that touch, in point spacings

Gaps = Mapping[tuple[int, int], float]
"""Gaps by the labels of two segments, in either order."""


@dataclass(frozen=True)
class Neighbors:
    """The nearest other points of each of N points, nearest first; k is at most N - 1."""

    indices: NDArray[np.int32]  # (N, k)
    distances: NDArray[np.float32]  # (N, k)

    @property
    def spacing(self) -> float:
        """Median distance to the nearest neighbour; 0 where there is none."""
        return float(np.median(self.distances[:, 0])) if self.distances.size else 0.0

    @property
    def reach(self) -> NDArray[np.float32]:
        """(N,) float32, the distance to the 8th neighbour, or to the last one of fewer."""
        if not self.distances.size:
            return np.zeros(len(self.distances), np.float32)
        return self.distances[:, :NEIGHBORS_FOR_REACH][:, -1]

    @property
    def inliers(self) -> NDArray[np.bool_]:
        """(N,) bool, whether a point's reach is at most ten times the median."""
        return self.reach <= OUTLIER_RATIO * np.median(self.reach)

    def first(self, k: int) -> "Neighbors":
        """The k nearest of these, or all of fewer."""
        return Neighbors(self.indices[:, :k], self.distances[:, :k])


def nearest_neighbors(
    points: NDArray[np.floating], k: int = NEIGHBORS, workers: int = 1
) -> Neighbors:
    """Query the k nearest other points of each point.

    Equivalent to ``KDTree(points).query(points, k + 1)`` without each point itself. The points are
    queried along a Morton curve: where a file has them in any order that takes a third of the time.

    Parameters
    ----------
    points : (N, 3) float, N > 0
    k, workers : int
        Neighbours, at most N - 1, and threads.
    """
    from scipy.spatial import KDTree

    k = min(k, len(points) - 1)
    order = morton_order(points)
    ordered, numbers = points[order], order.astype(np.int32)
    tree, ranks = KDTree(ordered, balanced_tree=False), np.arange(1, k + 2)
    shape = len(points), k
    found = Neighbors(np.empty(shape, np.int32), np.empty(shape, np.float32))
    for part in blocks(len(points)):
        distances, nearest = tree.query(ordered[part], ranks, workers=workers)
        # Of points in one place, any may come first: each itself is moved to the first column.
        own = np.arange(part.start, part.start + len(nearest))
        other = np.flatnonzero(nearest[:, 0] != own)
        itself = np.argmax(nearest[other] == own[other, None], axis=1)
        nearest[other, itself] = nearest[other, 0]
        found.indices[order[part]] = numbers.take(nearest[:, 1:])
        found.distances[order[part]] = distances[:, 1:]
    return found


def blocks(count: int) -> list[slice]:
    """Slices of so many points, which stay in the processor's cache."""
    return [slice(begin, begin + POINTS_AT_ONCE) for begin in range(0, count, POINTS_AT_ONCE)]


def point_spacing(points: NDArray[np.floating]) -> float:
    """Median distance from a point of an (N, 3) cloud to its nearest neighbour; 0 for N < 2."""
    return nearest_neighbors(points, 1).spacing if len(points) > 1 else 0.0


def segment_adjacency(labels: NDArray[np.integer], neighbors: Neighbors) -> Gaps:
    """Find the segments that touch, and the smallest distance between points of theirs.

    Parameters
    ----------
    labels, neighbors : (N,) int, Neighbors
        The segment of each point, and what is around it.

    Returns
    -------
    Gaps, in length units, of all nearer than three point spacings.
    """
    names, segment = np.unique(labels, return_inverse=True)
    touching = segment[neighbors.indices] != segment[:, None]
    touching &= neighbors.distances <= MAX_GAP * neighbors.spacing
    i, column = np.nonzero(touching)
    ends = np.sort(segment[np.stack([i, neighbors.indices[i, column]])], axis=0)
    pairs, number = np.unique(ends[0] * len(names) + ends[1], return_inverse=True)
    gaps = np.full(len(pairs), np.inf)
    np.minimum.at(gaps, number, neighbors.distances[i, column])
    first, second = (names[side].tolist() for side in np.divmod(pairs, len(names)))
    found = dict(zip(zip(first, second, strict=True), gaps.tolist(), strict=True))
    return found | {(b, a): gap for (a, b), gap in found.items()}


def agreed_gaps(
    labels: Sequence[NDArray[np.integer]], adjacency: Sequence[Gaps], spacings: Sequence[float]
) -> Gaps:
    """Mean gaps between an organ and what it may grow from, over all scans that show both.

    In a dense crown leaves touch branches that they don't grow from, and in a single scan they may
    be nearer to those than a branch is to its parent. An organ's parent touches it in every scan.

    Parameters
    ----------
    labels, adjacency, spacings : sequences of (N,) int, Gaps and float
        Of each scan the organ of each point, which has the same label in all scans, its
        `segment_adjacency` and its point spacing.

    Returns
    -------
    Gaps from (organ, possible parent), in point spacings, of all that touch in some scan. Where
    they don't touch they count as far apart as what barely does. Nothing grows from what is
    younger.
    """
    shown = [set(np.unique(names).tolist()) for names in labels]
    first = {label: scan for scan in reversed(range(len(shown))) for label in shown[scan]}
    pairs = sorted({pair for gaps in adjacency for pair in gaps})
    agreed = {}
    for pair in (pair for pair in pairs if first[pair[1]] <= first[pair[0]]):
        seen = (k for k, present in enumerate(shown) if present.issuperset(pair))
        gaps = [adjacency[k].get(pair, MAX_GAP * spacings[k]) / spacings[k] for k in seen]
        agreed[pair] = float(np.mean(gaps))
    return agreed
