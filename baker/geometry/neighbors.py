"""The k nearest neighbours of every point of a cloud, and what is read off them.

One query a scan answers for point spacing, point area, outliers, label cleaning, segment adjacency
and graphs; none of them changes when the scan is moved rigidly.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gclip.morton import morton_order

NEIGHBORS = 10  # enough for a point at the border of a segment to see the next segment
NEIGHBORS_FOR_REACH = 8  # a point's reach is the distance to its 8th neighbour
OUTLIER_RATIO = 10.0  # an outlier reaches so many times as far as the median point
PLANAR_RATIO = 1.5  # squared reach over spread from which on points lie on a thin rod
MAX_AREA_QUANTILE = 0.98  # of all points' areas, that none exceeds
POINTS_AT_ONCE = 50_000  # whose neighbourhoods are held in memory together


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
    stops = range(POINTS_AT_ONCE, len(points), POINTS_AT_ONCE)
    for part in np.split(np.arange(len(points)), stops):
        distances, nearest = tree.query(ordered[part], ranks, workers=workers)
        # Of points in one place, any may come first: each itself is moved to the first column.
        other = np.flatnonzero(nearest[:, 0] != part)
        itself = np.argmax(nearest[other] == part[other, None], axis=1)
        nearest[other, itself] = nearest[other, 0]
        found.indices[order[part]] = numbers.take(nearest[:, 1:])
        found.distances[order[part]] = distances[:, 1:]
    return found


def point_spacing(points: NDArray[np.floating]) -> float:
    """Median distance from a point of an (N, 3) cloud to its nearest neighbour; 0 for N < 2."""
    return nearest_neighbors(points, 1).spacing if len(points) > 1 else 0.0


def covariances(points: NDArray[np.floating], neighbors: Neighbors) -> NDArray[np.float64]:
    """Covariance of the positions of each point and its neighbors.

    Parameters
    ----------
    points, neighbors : (N, 3) float, Neighbors

    Returns
    -------
    (6, N) float64
        The elements xx, yy, zz, xy, yz and zx, in squared units of the points.
    """
    found = np.empty((6, len(points)))
    columns = np.ascontiguousarray(points.T, np.float64)
    for begin in range(0, len(points), POINTS_AT_ONCE):
        part = slice(begin, begin + POINTS_AT_ONCE)
        near = neighbors.indices[part].T.copy()  # neighbour by neighbour
        count = len(near) + 1
        x, y, z = (axis.take(near) - axis[part] for axis in columns)  # the point itself is at 0
        for element, (a, b) in enumerate(((x, x), (y, y), (z, z), (x, y), (y, z), (z, x))):
            products = np.einsum("kn,kn->n", a, b)
            found[element, part] = (products - a.sum(axis=0) * b.sum(axis=0) / count) / count
    return found


def point_area(points: NDArray[np.floating], neighbors: Neighbors) -> NDArray[np.float64]:
    """Area of the surface that each point stands for, up to a common factor.

    On a surface it is the squared reach. A twig thinner than its point spacing has far less: no
    more than the area of the disk on which the neighbourhood has the same covariance. Isolated
    points count no more than most others do.

    Parameters
    ----------
    points, neighbors : (N, 3) float, Neighbors

    Returns
    -------
    (N,) float64, in squared units of the points; 1 where a cloud has but one point.
    """
    if not neighbors.indices.size:
        return np.ones(len(points))
    area = neighbors.reach.astype(np.float64) ** 2
    xx, yy, zz, xy, yz, zx = covariances(points, neighbors.first(NEIGHBORS_FOR_REACH))
    # The products of two principal variances, summed: on a sheet that of the larger two. On a
    # disk, evenly covered, each of those is a quarter of the squared radius.
    products = xx * yy + yy * zz + zz * xx - xy**2 - yz**2 - zx**2
    spread = 4.0 * np.sqrt(np.maximum(products, 0.0))
    area = np.minimum(area, PLANAR_RATIO * spread)
    return np.minimum(area, np.quantile(area, MAX_AREA_QUANTILE))
