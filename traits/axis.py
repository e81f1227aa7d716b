"""Estimate the medial axis of an organ, from its attachment point to its tip."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from traits.neighbors import Neighbors

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

Points = NDArray[np.float64]

# Lengths are in point spacings (the median distance to the nearest neighbour), unless noted.
GRAPH_NEIGHBORS = 10  # of a point in the kNN graph
MIN_POINTS = 6  # of an organ
SLICE_LENGTH, MAX_SLICES = 3.0, 40  # along the axis; greatest number of slices
MAX_DETOUR = 8.0  # of a path over a point of the axis; paths over leaflets are longer
BASE_RIM = 3.0  # greatest difference in distance from the tip of points of the base
MAX_BASE_GAP = 0.15  # between the base and the parent, in lengths of the organ
MAX_TIP_EXTRAPOLATION = 3.0  # of the axis beyond the outermost point


@dataclass(frozen=True)
class Axis:
    """The medial axis of an organ.

    Attributes
    ----------
    line : ndarray of shape (n, 3)
        Points along the axis, from the attachment point to the tip.
    start : ndarray of shape (3,)
        Unit vector in the direction of the first quarter of the organ.
    """

    line: Points
    start: Points

    @property
    def length(self) -> float:
        """Length of the axis, in the unit of the points."""
        return float(np.linalg.norm(np.diff(self.line, axis=0), axis=1).sum())

    def angle(self, direction: NDArray[np.float64]) -> float:
        """Angle between the first quarter and a unit vector, in degrees."""
        return float(np.degrees(np.arccos(np.clip(self.start @ direction, -1.0, 1.0))))


def axis_of(
    points: Points, neighbors: Neighbors, parent: Points, up: NDArray[np.float64]
) -> Axis | None:
    """Estimate the medial axis of an organ.

    The two ends are the points with the largest geodesic distance on the kNN graph. If both are far
    from the parent, as in a branch with leaves, the base is the point nearest to the parent. The
    organ is divided into slices by geodesic distance, and the axis connects their centroids.

    Parameters
    ----------
    points : ndarray of shape (N, 3), float64
        Points of the organ.
    neighbors : Neighbors
        Of the points.
    parent : ndarray of shape (M, 3), float64
        Points of the organ that it grows on, which determine the base. Empty for the stem, whose
        base is its lower end.
    up : ndarray of shape (3,)
        Unit vector.

    Returns
    -------
    Axis or None
        None for fewer than 6 points, or if all points coincide.
    """
    from scipy.sparse.csgraph import dijkstra

    if len(points) < MIN_POINTS or not np.ptp(points, axis=0).any():
        return None
    graph, spacing = _graph(points, neighbors)

    @cache  # the base and the tip are usually the two ends, from which distances are known then
    def distances_from(*sources: int) -> NDArray[np.float64]:
        return dijkstra(graph, directed=False, indices=list(sources), min_only=True)

    base = _base(points, parent, up, distances_from, spacing)
    from_base = distances_from(base)
    tip = int(from_base.argmax())
    from_tip, length = distances_from(tip), float(from_base[tip])
    if length <= 0.0:
        return None
    is_base = from_tip >= from_tip[base] - BASE_RIM * spacing
    is_base &= np.linalg.norm(points - points[base], axis=1) <= length / 4
    from_base = distances_from(base, *np.flatnonzero(is_base).tolist())
    path_length = from_base + from_tip
    length = float(path_length.min())
    on_axis = np.flatnonzero(path_length <= length + MAX_DETOUR * spacing)  # without leaflets
    share = (from_base - from_tip + length)[on_axis] / (2.0 * length)
    count = int(min(length / (SLICE_LENGTH * spacing), MAX_SLICES, len(on_axis) / 6))
    centroids = _slice_centroids(points[on_axis], share, max(count, 3))
    outer_half, limit = points[on_axis][share > 0.5], MAX_TIP_EXTRAPOLATION * spacing
    line = np.concatenate(
        [
            _end(points[base], centroids[0], centroids[1]),
            centroids,
            _end(points[tip], centroids[-1], centroids[-2], outer_half, limit),
        ]
    )
    return Axis(line, _start_direction(line, points[on_axis], share))


def _base(
    points: Points,
    parent: Points,
    up: NDArray[np.float64],
    distances_from: Callable[..., NDArray[np.float64]],
    spacing: float,
) -> int:
    """Index of the attachment point: the end of the organ that is nearer to its parent."""
    from scipy.spatial import cKDTree

    farthest = int(distances_from(0).argmax())
    from_farthest = distances_from(farthest)
    ends = [farthest, int(from_farthest.argmax())]
    if not len(parent):
        return min(ends, key=lambda end: float(points[end] @ up))
    gap = cKDTree(parent).query(points)[0]
    base = min(ends, key=lambda end: float(gap[end]))
    nearest = int(gap.argmin())
    max_gap = gap[nearest] + MAX_BASE_GAP * from_farthest.max() + BASE_RIM * spacing
    return base if gap[base] <= max_gap else nearest


def _slice_centroids(points: Points, share: NDArray[np.float64], count: int) -> Points:
    """(n, 3) centroids of the slices, smoothed by a binomial filter; at least two."""
    number = np.clip((share * count).astype(int), 0, count - 1)
    _, number = np.unique(number, return_inverse=True)
    size = np.bincount(number)
    centroids = np.stack([np.bincount(number, column) / size for column in points.T], axis=1)
    if len(centroids) == 1:
        return np.repeat(centroids, 2, axis=0)
    centroids[1:-1] = centroids[1:-1] / 2 + (centroids[:-2] + centroids[2:]) / 4
    return centroids


def _start_direction(line: Points, points: Points, share: NDArray[np.float64]) -> Points:
    """Direction of the first quarter, by regression of points on relative geodesic distance.

    Unlike the principal axis, it is right for stems whose width is as large as a quarter's length.
    """
    direction = chord = line[min(2, len(line) - 1)] - line[0]
    quarter = share <= 0.25
    if quarter.sum() > 2:
        centered = points[quarter] - points[quarter].mean(axis=0)
        slope = (share[quarter] - share[quarter].mean()) @ centered
        direction = slope if slope.any() else chord
    direction = direction / max(float(np.linalg.norm(direction)), 1e-300)
    return direction if direction @ chord >= 0.0 else -direction


def _end(
    point: Points, last: Points, before: Points, around: Points | None = None, limit: float = 0.0
) -> Points:
    """(1, 3) end of the axis: its straight continuation to the level of the outermost point.

    That point itself may be beside the axis, at the edge of a stem or in a corner of a leaf.

    last, before: the last two points of the axis. With `around`, (M, 3) points around a tip,
    the axis is extrapolated, since the tip is rarely sampled: by the expected distance from the
    outermost of all points to the outermost of a random half of them, at most by `limit`.
    """
    direction = last - before
    direction = direction / max(float(np.linalg.norm(direction)), 1e-300)
    extrapolation = 0.0
    if around is not None and len(around):
        level = np.sort(around @ direction)[:-32:-1]
        # The outermost point is in a random half with probability 1/2, else the second outermost is
        # that half's extreme with probability 1/4, and so on.
        expected = (level[0] - level) @ (0.5 ** np.arange(1, len(level) + 1))
        extrapolation = min(float(expected), limit)
    return (last + (max(float((point - last) @ direction), 0.0) + extrapolation) * direction)[None]


def _graph(points: Points, neighbors: Neighbors) -> tuple[csr_matrix, float]:
    """Connected kNN graph with Euclidean edge lengths, and the point spacing.

    Components are joined to the largest one by their shortest edge, one after the other.
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    distances, indices = (values[:, :GRAPH_NEIGHBORS] for values in neighbors)
    count, k = indices.shape
    spacing = float(np.median(distances[:, 0]))
    smallest = 1e-9 * max(float(distances.max()), 1e-300)  # scipy drops edges of length 0
    edges = np.column_stack([np.repeat(np.arange(count), k), indices.ravel()])
    lengths = distances.ravel()
    while True:
        weights = np.maximum(lengths, smallest)
        graph = coo_matrix((weights, edges.T), shape=(count, count)).tocsr()
        parts, part = connected_components(graph, directed=False)
        if parts == 1:
            return graph, max(spacing, smallest)
        is_largest = part == np.bincount(part).argmax()
        inside, outside = np.flatnonzero(is_largest), np.flatnonzero(~is_largest)
        gap, nearest = cKDTree(points[inside]).query(points[outside])
        best = int(gap.argmin())
        edges = np.vstack([edges, [outside[best], inside[nearest[best]]]])
        lengths = np.append(lengths, gap[best])
