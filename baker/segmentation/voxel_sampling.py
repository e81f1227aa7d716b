"""An even sample of a plant, and how far each of its points is from the stem's base along it.

All lengths of the organ segmentation are shares of the stem's diameter, which is measured here: so
it does not matter in what unit, how densely or how evenly a plant was scanned.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import connected_knn_graph
from baker.geometry.neighbors import NEIGHBORS_FOR_REACH, nearest_neighbors, point_spacing

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

COARSE, FINE = 4_000, 10_000  # points at most: to measure the stem, and to segment with
GRAIN = 0.2  # size of the sample's cubes, in stem diameters
THICKNESS, FINEST = 0.5, 3.0  # of a level set: in stem diameters, at least this many spacings
STEM = 6.0  # how far up the stem is measured, in its diameters
FEWEST = 6  # points of a section that is measured
ROUNDS = 15


@dataclass(frozen=True)
class EvenSample:
    """A plant's points, thinned evenly.

    points:   (n, 3) float64.
    nearest:  (N,) the sample's point nearest to each point of the cloud.
    graph:    (n, n) edges between neighbours, each once, gaps bridged, weighted by length.
    distance: (n,) way along the graph from the stem's base; before: (n,) the point before each on
              that way, -1 at the base.
    spacing:  median distance of neighbours.
    diameter: of the stem; 0 where the cloud is too small to tell.
    """

    points: NDArray[np.float64]
    nearest: NDArray[np.intp]
    graph: csr_matrix
    distance: NDArray[np.float64]
    before: NDArray[np.intp]
    spacing: float
    diameter: float

    @property
    def thickness(self) -> float:
        """Of a level set of the distance."""
        return max(THICKNESS * self.diameter, FINEST * self.spacing)


def even_sample(points: NDArray[np.floating], root: int, neighbors: int) -> EvenSample:
    """Thin an (N, 3) cloud to a fifth of its stem's diameter; `root`: the point at its base."""
    cloud = np.asarray(points, np.float64)
    coarse = _walked(cloud, _thinned(cloud, _cube_for(cloud, COARSE)), root, neighbors)
    if coarse.diameter == 0.0:
        return coarse
    fine = max(GRAIN * coarse.diameter, _cube_for(cloud, FINE))
    return _walked(cloud, _thinned(cloud, fine), root, neighbors)


def _thinned(cloud: NDArray[np.float64], size: float) -> NDArray[np.intp]:
    """Indices of one point of each cube, without those that are alone."""
    kept = one_per_cube(cloud, size)
    return kept[nearest_neighbors(cloud[kept], NEIGHBORS_FOR_REACH).inliers]


def one_per_cube(points: NDArray[np.float64], size: float) -> NDArray[np.intp]:
    """Indices of one point of each cube of that size: the first there is."""
    if size <= 0.0:
        return np.arange(len(points))
    return np.sort(np.unique(_cubes(points, size), return_index=True)[1])


def _cubes(points: NDArray[np.float64], size: float) -> NDArray[np.int64]:
    cell = np.floor((points - points.min(axis=0)) / size).astype(np.int64)
    sides = cell.max(axis=0) + 1
    return np.asarray((cell[:, 0] * sides[1] + cell[:, 1]) * sides[2] + cell[:, 2], np.int64)


def _cube_for(points: NDArray[np.float64], count: int) -> float:
    """The smallest size of cubes of which at most `count` have points in them, to 2 %."""
    if len(points) <= count:
        return 0.0
    large = float(np.ptp(points, axis=0).max())
    small = 1e-4 * large
    while large > 1.02 * small:
        middle = float(np.sqrt(small * large))
        if len(np.unique(_cubes(points, middle))) > count:
            small = middle
        else:
            large = middle
    return large


def _walked(
    cloud: NDArray[np.float64], kept: NDArray[np.intp], root: int, neighbors: int
) -> EvenSample:
    from scipy.sparse.csgraph import dijkstra
    from scipy.spatial import cKDTree

    points = cloud[kept]
    tree = cKDTree(points)
    graph, _, _ = connected_knn_graph(points, neighbors)
    base = int(tree.query(cloud[root])[1])
    distance, before = dijkstra(graph, directed=False, indices=base, return_predecessors=True)
    before = np.where(before < 0, -1, before).astype(np.intp)
    spacing = point_spacing(points)
    diameter = _stem_diameter(points, graph, distance, spacing)
    nearest = tree.query(cloud)[1]
    return EvenSample(points, nearest, graph, distance, before, spacing, diameter)


def _stem_diameter(
    points: NDArray[np.float64],
    graph: csr_matrix,
    distance: NDArray[np.float64],
    spacing: float,
) -> float:
    """Median width of the sections up to six diameters above the base: a fixed point, found by
    iteration; 0 where there are none."""
    if spacing == 0.0:
        return 0.0
    diameter = 8.0 * spacing
    for _ in range(ROUNDS):
        thickness = max(THICKNESS * diameter, FINEST * spacing)
        found = _sections(points, graph, distance, 0.5 * diameter, STEM * diameter, thickness)
        if not found:
            return 0.0
        widths, counts = np.array(found).T
        order = np.argsort(widths, kind="stable")
        middle = np.searchsorted(np.cumsum(counts[order]), counts.sum() / 2)
        before, diameter = diameter, float(widths[order[middle]])
        if abs(diameter - before) < 0.02 * before:
            break
    return diameter


def _sections(
    points: NDArray[np.float64],
    graph: csr_matrix,
    distance: NDArray[np.float64],
    low: float,
    high: float,
    thickness: float,
) -> list[tuple[float, int]]:
    """Width and number of points of each connected part of the level sets from `low` to `high`."""
    from scipy.sparse.csgraph import connected_components

    found = []
    for begin in np.arange(low, high, thickness):
        level = np.flatnonzero((distance >= begin) & (distance < begin + thickness))
        if len(level) < FEWEST:
            continue
        _, part = connected_components(graph[level][:, level], directed=False)
        order = np.argsort(part, kind="stable")
        for members in np.split(level[order], np.flatnonzero(np.diff(part[order])) + 1):
            if len(members) >= FEWEST:
                width = section_width(points[members], distance[members])
                found.append((width, len(members)))
    return found


def section_width(points: NDArray[np.float64], distance: NDArray[np.float64]) -> float:
    """Diameter of the circle that the points of a section would lie on, seen along the way up."""
    centred = points - points.mean(axis=0)
    along = centred.T @ (distance - distance.mean())
    length = np.linalg.norm(along)
    if length > 0.0:
        along /= length
        centred = centred - np.outer(centred @ along, along)
    return float(2.0 * np.sqrt((centred**2).sum(axis=1).mean()))
