"""An organ's axis: the middle line from where it is attached to its tip."""

from __future__ import annotations

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
SLENDER = 1.3  # times as long as wide: what has a direction of its own
CORRIDOR = 8.0  # detour, in point spacings, up to which points belong to the way along the organ


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
    graph. Slices across the way between them have their middles on the axis.
    """
    from scipy.sparse.csgraph import dijkstra
    from scipy.spatial import cKDTree

    if len(points) < 6 or not np.ptp(points, axis=0).any():
        return None
    graph, spacing = _graph(points)

    def way(source: int) -> NDArray[np.float64]:
        return dijkstra(graph, directed=False, indices=source)

    tip = int(way(0).argmax())
    from_tip = way(tip)
    base = int(from_tip.argmax())
    ends = points[[base, tip]]
    near = cKDTree(parent).query(ends)[0] if len(parent) else ends @ up
    from_base = way(base)
    if near[1] < near[0]:
        base, tip, from_base, from_tip = tip, base, from_tip, from_base

    whole = from_base[tip]
    if whole <= 0.0:
        return None
    # Leaflets beside the way are no part of it.
    along = np.flatnonzero(from_base + from_tip - whole <= CORRIDOR * spacing)
    share = (from_base - from_tip + whole)[along] / (2.0 * whole)
    count = int(min(whole / (SLICE * spacing), SLICES, len(along) / 6))
    middles = _middles(points[along], share, max(count, 3))
    line = np.concatenate(
        [
            _end(points[base], middles[0], middles[1]),
            middles,
            _end(points[tip], middles[-1], middles[-2]),
        ]
    )
    return Axis(line, _start(line, points[along][share <= 0.25]))


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


def _start(line: Points, quarter: Points) -> Points:
    """(3,) the way from the line's base to a quarter of its length; where the quarter's points
    themselves are clearly longer than wide, along them: ways begin at a point of a stem's rim, and
    so does the line.
    """
    passed = np.linalg.norm(np.diff(line, axis=0), axis=1).cumsum()
    place = [np.interp(0.25 * passed[-1], [0.0, *passed], column) for column in line.T]
    chord = np.array(place) - line[0]
    chord /= max(float(np.linalg.norm(chord)), 1e-300)
    if len(quarter) < 12:
        return chord
    about = quarter - quarter.mean(axis=0)
    spread, axes = np.linalg.eigh(about.T @ about)
    if spread[2] < SLENDER**2 * spread[1]:
        return chord
    return axes[:, 2] * (1.0 if axes[:, 2] @ chord >= 0.0 else -1.0)


def _end(point: Points, last: Points, before: Points) -> Points:
    """(1, 3) the axis goes on straight until it is level with its outermost point: that may lie
    on the rim of a stem's end, or at the corner of a leaf's base.
    """
    onward = last - before
    onward = onward / max(float(np.linalg.norm(onward)), 1e-300)
    return (last + max(float((point - last) @ onward), 0.0) * onward)[None]


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
