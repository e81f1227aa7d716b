"""An organ's axis: the middle line from where it is attached to its tip."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

Points = NDArray[np.float64]

NEIGHBORS = 10
SLICE = 3.0  # length of a slice, in point spacings
SLICES = 40  # at most
CORRIDOR = 8.0  # detour, in point spacings, up to which points belong to the way along the organ
RIM = 3.0  # how far from its very end, in point spacings, an organ's base may reach
NEAR = 0.15  # of an organ's length: how far from its parent an end may lie to be its base
BEYOND = 3.0  # point spacings: the most that a tip lies beyond the last point


@dataclass(frozen=True)
class Axis:
    """(n, 3) places along an organ, from its base to its tip; and (3,) which way its first quarter
    goes, a unit vector.
    """

    line: Points
    start: Points

    @property
    def length(self) -> float:
        return float(np.linalg.norm(np.diff(self.line, axis=0), axis=1).sum())

    def angle(self, direction: NDArray[np.float64]) -> float:
        """Degrees between a unit direction and the first quarter's."""
        return float(np.degrees(np.arccos(np.clip(self.start @ direction, -1.0, 1.0))))


def axis_of(points: Points, parent: Points, up: NDArray[np.float64]) -> Axis | None:
    """The axis of an organ with (N, 3) points; None for fewer than 6.

    parent: (M, 3) points of the organ it grows on; the end of the axis nearer to it is the base.
            Empty for the root: then it is the lower end.

    The two ends are the points farthest apart along the surface, measured over a neighbourhood
    graph; of a branch with leaves both may be tips, then the base is where it touches its parent.
    A stem's base is its whole rim. Slices across the way from the base to the tip have their
    middles on the axis.
    """
    from scipy.sparse.csgraph import dijkstra

    if len(points) < 6 or not np.ptp(points, axis=0).any():
        return None
    graph, spacing = _graph(points)

    def way(*sources: int) -> NDArray[np.float64]:
        return dijkstra(graph, directed=False, indices=list(sources), min_only=True)

    base = _base(points, parent, up, way, spacing)
    from_base = way(base)
    tip = int(from_base.argmax())
    from_tip, whole = way(tip), float(from_base[tip])
    if whole <= 0.0:
        return None
    rim = from_tip >= from_tip[base] - RIM * spacing
    rim &= np.linalg.norm(points - points[base], axis=1) <= whole / 4
    from_base = way(base, *np.flatnonzero(rim).tolist())
    detour = from_base + from_tip
    whole = float(detour.min())
    # Leaflets beside the way are no part of it.
    along = np.flatnonzero(detour <= whole + CORRIDOR * spacing)
    share = (from_base - from_tip + whole)[along] / (2.0 * whole)
    count = int(min(whole / (SLICE * spacing), SLICES, len(along) / 6))
    middles = _middles(points[along], share, max(count, 3))
    last = points[along][share > 0.5]
    line = np.concatenate(
        [
            _end(points[base], middles[0], middles[1]),
            middles,
            _end(points[tip], middles[-1], middles[-2], last, BEYOND * spacing),
        ]
    )
    return Axis(line, _start(line, points[along], share))


def _base(
    points: Points,
    parent: Points,
    up: NDArray[np.float64],
    way: Callable[..., NDArray[np.float64]],
    spacing: float,
) -> int:
    """Which point of an organ is farthest from its tip."""
    from scipy.spatial import cKDTree

    first = int(way(0).argmax())
    across = way(first)
    ends = [first, int(across.argmax())]
    if not len(parent):
        return min(ends, key=lambda end: float(points[end] @ up))
    gap = cKDTree(parent).query(points)[0]
    base = min(ends, key=lambda end: float(gap[end]))
    touching = int(gap.argmin())
    return base if gap[base] <= gap[touching] + NEAR * across.max() + RIM * spacing else touching


def _middles(points: Points, share: NDArray[np.float64], count: int) -> Points:
    """(n, 3) middles of slices across the way, a little evened out; at least two."""
    number = np.clip((share * count).astype(int), 0, count - 1)
    _, number = np.unique(number, return_inverse=True)
    size = np.bincount(number)
    middles = np.stack([np.bincount(number, column) / size for column in points.T], axis=1)
    if len(middles) == 1:
        return np.repeat(middles, 2, axis=0)
    middles[1:-1] = middles[1:-1] / 2 + (middles[:-2] + middles[2:]) / 4
    return middles


def _start(line: Points, points: Points, share: NDArray[np.float64]) -> Points:
    """(3,) which way an organ's first quarter goes: the line that best says where its points are
    by how far along they are. Thick stems, as wide as their quarter is long, have it too.
    """
    quarter = share <= 0.25
    about = points[quarter] - points[quarter].mean(axis=0) if quarter.any() else points[:0]
    way = (share[quarter] - share[quarter].mean()) @ about if len(about) > 2 else np.zeros(3)
    chord = line[min(2, len(line) - 1)] - line[0]
    way = way if way.any() else chord
    way = way / max(float(np.linalg.norm(way)), 1e-300)
    return way if way @ chord >= 0.0 else -way


def _end(
    point: Points, last: Points, before: Points, near: Points | None = None, most: float = 0.0
) -> Points:
    """(1, 3) the axis goes on straight until it is level with its outermost point: that may lie
    on the rim of a stem's end, or at the corner of a leaf's base.

    near: (M, 3) points of which the outermost is one; then it goes on by as much as the outermost
          of half of them lies behind it, in the mean over all halves: a tip is seen no better
          than that. `most`: but no farther than that.
    """
    onward = last - before
    onward = onward / max(float(np.linalg.norm(onward)), 1e-300)
    beyond = 0.0
    if near is not None and len(near):
        level = np.sort(near @ onward)[:-32:-1]
        # The outermost is one of a half's points with probability 1/2, the next is its first with
        # 1/4, and so on.
        behind = (level[0] - level) @ (0.5 ** np.arange(1, len(level) + 1))
        beyond = min(float(behind), most)
    return (last + (max(float((point - last) @ onward), 0.0) + beyond) * onward)[None]


def _graph(points: Points) -> tuple[csr_matrix, float]:
    """Neighbours joined by their distances, in one piece; and the median distance to the nearest.

    Parts are joined by their shortest gap to the largest one, one after the other.
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    count, k = len(points), min(NEIGHBORS, len(points) - 1)
    distance, neighbors = cKDTree(points).query(points, k=k + 1)
    spacing = float(np.median(distance[:, 1]))
    smallest = 1e-9 * max(float(distance.max()), 1e-300)  # scipy drops edges of length 0
    rows = [np.repeat(np.arange(count), k)]
    columns, lengths = [neighbors[:, 1:].ravel()], [distance[:, 1:].ravel()]
    while True:
        edges = (np.concatenate(rows), np.concatenate(columns))
        weights = np.maximum(np.concatenate(lengths), smallest)
        graph = coo_matrix((weights, edges), shape=(count, count)).tocsr()
        parts, part = connected_components(graph, directed=False)
        if parts == 1:
            return graph, max(spacing, smallest)
        largest = part == np.bincount(part).argmax()
        inside, outside = np.flatnonzero(largest), np.flatnonzero(~largest)
        gap, nearest = cKDTree(points[inside]).query(points[outside])
        best = int(gap.argmin())
        rows.append(outside[[best]])
        columns.append(inside[[nearest[best]]])
        lengths.append(gap[[best]])
