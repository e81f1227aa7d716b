"""The k nearest neighbours of every point of a cloud, and measures that are derived from them.

One query for each scan is enough for point spacing, outliers, normals, areas, label cleaning,
segment adjacency and graphs, since rigid motions don't change it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.geometry.parallel import MapLike
from gclip.morton import morton_order

NEIGHBORS = 10  # enough to include the next segment for points at the border of a segment
NEIGHBORS_FOR_REACH = 8  # a point's reach is the distance to its 8th neighbour
OUTLIER_RATIO = 10.0  # reach of an outlier : median reach
BLOCK_SIZE = 4_000  # points that are processed together
MAX_GAP = 3.0  # between adjacent segments, in point spacings

Gaps = Mapping[tuple[int, int], float]
"""The labels of two adjacent segments, in either order -> distance between them."""


@dataclass(frozen=True)
class Neighbors:
    """The k nearest other points of each of N points, sorted by distance."""

    indices: NDArray[np.int32]  # (N, k)
    distances: NDArray[np.float32]  # (N, k)

    @property
    def spacing(self) -> float:
        """Median distance to the nearest neighbour; 0 for a single point."""
        return float(np.median(self.distances[:, 0])) if self.distances.size else 0.0

    @property
    def reach(self) -> NDArray[np.float32]:
        """(N,) float32, the distance to the 8th neighbour, or to the last one."""
        if not self.distances.size:
            return np.zeros(len(self.distances), np.float32)
        return self.distances[:, :NEIGHBORS_FOR_REACH][:, -1]

    @property
    def inliers(self) -> NDArray[np.bool_]:
        """(N,) bool, whether a point's reach is at most ten times the median reach."""
        return self.reach <= OUTLIER_RATIO * np.median(self.reach)

    def first(self, k: int) -> "Neighbors":
        """The k nearest of these neighbours; they do not keep the others in memory."""
        return Neighbors(
            np.ascontiguousarray(self.indices[:, :k]), np.ascontiguousarray(self.distances[:, :k])
        )


def nearest_neighbors(
    points: NDArray[np.floating], k: int = NEIGHBORS, map: MapLike = map
) -> Neighbors:
    """Query the k nearest other points of each point.

    Equivalent to ``KDTree(points).query(points, k + 1)`` without each point itself. The points are
    queried along a Morton curve, which takes a third of the time for points in random order.

    Parameters
    ----------
    points : (N, 3) float, N > 0
    k : int
        Number of neighbours, reduced to N - 1.
    map : map-like callable
        Maps over blocks of points, in threads.
    """
    from scipy.spatial import KDTree

    k = min(k, len(points) - 1)
    order = morton_order(points)
    ordered, numbers = points[order], order.astype(np.int32)
    tree, ranks = KDTree(ordered, balanced_tree=False), np.arange(1, k + 2)
    shape = len(points), k
    found = Neighbors(np.empty(shape, np.int32), np.empty(shape, np.float32))

    def query(part: slice) -> None:
        distances, nearest = tree.query(ordered[part], ranks)
        # Among duplicates, a point may not be its own first neighbour: move it to the first column.
        own = np.arange(part.start, part.start + len(nearest))
        duplicates = np.flatnonzero(nearest[:, 0] != own)
        column = np.argmax(nearest[duplicates] == own[duplicates, None], axis=1)
        nearest[duplicates, column] = nearest[duplicates, 0]
        found.indices[order[part]] = numbers.take(nearest[:, 1:])
        found.distances[order[part]] = distances[:, 1:]

    for _ in map(query, blocks(len(points))):
        pass
    return found


def blocks(count: int) -> list[slice]:
    """Slices of `count` points in blocks that fit into the processor's cache."""
    return [slice(begin, begin + BLOCK_SIZE) for begin in range(0, count, BLOCK_SIZE)]


def point_spacing(points: NDArray[np.floating]) -> float:
    """Median distance from (N, 3) points to their nearest neighbours; 0 for N < 2."""
    return nearest_neighbors(points, 1).spacing if len(points) > 1 else 0.0


def segment_adjacency(labels: NDArray[np.integer], neighbors: Neighbors) -> Gaps:
    """Find pairs of adjacent segments, and the smallest distance between their points.

    Parameters
    ----------
    labels, neighbors : (N,) int, Neighbors

    Returns
    -------
    Gaps
        In length units, of segments within three point spacings.
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
    adjacent = dict(zip(zip(first, second, strict=True), gaps.tolist(), strict=True))
    return adjacent | {(b, a): gap for (a, b), gap in adjacent.items()}


def agreed_gaps(
    labels: Sequence[NDArray[np.integer]], adjacency: Sequence[Gaps], spacings: Sequence[float]
) -> Gaps:
    """Mean gaps between organs and their possible parents, over all scans with both.

    In a dense crown, leaves touch branches that they don't grow from, and may be nearer to them in
    a single scan than to their parent. But an organ touches its parent in every scan.

    Parameters
    ----------
    labels : sequence of (N,) int
        The organ of each point of each scan, with consistent labels.
    adjacency, spacings : sequences of Gaps and float
        The `segment_adjacency` and point spacing of each scan.

    Returns
    -------
    Gaps
        Of (organ, possible parent), in point spacings. Where two organs are not adjacent in a
        scan, their gap counts as `MAX_GAP`. A parent is never younger than the organ.
    """
    present = [set(np.unique(names).tolist()) for names in labels]
    first = {label: scan for scan in reversed(range(len(present))) for label in present[scan]}
    pairs = sorted({pair for gaps in adjacency for pair in gaps})
    mean = {}
    for pair in (pair for pair in pairs if first[pair[1]] <= first[pair[0]]):
        scans = (k for k, organs in enumerate(present) if organs.issuperset(pair))
        gaps = [adjacency[k].get(pair, MAX_GAP * spacings[k]) / spacings[k] for k in scans]
        mean[pair] = float(np.mean(gaps))
    return mean
