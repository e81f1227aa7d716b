"""The k nearest neighbours of every point of a cloud, and measures that are derived from them.

One query for each scan is enough for point spacing, outliers, normals, areas, label cleaning
and graphs, since rigid motions don't change it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.geometry.morton import morton_order
from baker.geometry.parallel import MapLike

Points = NDArray[np.floating]

NEIGHBORS = 10  # enough to include the next segment for points at the border of a segment
NEIGHBORS_FOR_RADIUS = 8  # the radius of a neighbourhood is the distance to the 8th neighbour
OUTLIER_RATIO = 10.0  # ratio of an outlier's neighbourhood radius to the median radius
# Least ratio of the spacing of even points to that radius. The distance to the nearest neighbour is
# 0.47 to 0.51 of it in real scans, 0.4 if half of the points are left out at random, and 0.3 if all
# are at random.
EVEN_RATIO = 0.43
BLOCK_SIZE = 4_000  # points that are processed together
LEAF_SIZE = 16  # of KD-trees; with 10, as by default, queries of ten neighbours take 8 % longer


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
    def even_spacings(self) -> NDArray[np.float32]:
        """(N,) distance to the nearest neighbour, or more where the density of points tells so."""
        return np.maximum(EVEN_RATIO * self.radii, self.distances[:, :1].max(axis=1, initial=0.0))

    @property
    def radii(self) -> NDArray[np.float32]:
        """(N,) distance to the 8th (or last) neighbour; 0 for a single point."""
        return self.distances[:, :NEIGHBORS_FOR_RADIUS].max(axis=1, initial=0.0)

    @property
    def inliers(self) -> NDArray[np.bool_]:
        """(N,) whether the neighbourhood is at most ten times as large as in the median."""
        return self.radii <= OUTLIER_RATIO * np.median(self.radii)

    def first(self, k: int) -> "Neighbors":
        """The k nearest of these neighbours; they do not keep the others in memory."""
        return Neighbors(
            np.ascontiguousarray(self.indices[:, :k]), np.ascontiguousarray(self.distances[:, :k])
        )


def nearest_neighbors(points: Points, k: int = NEIGHBORS, map: MapLike = map) -> Neighbors:
    """Query the k nearest other points of each point.

    Equivalent to ``cKDTree(points).query(points, k + 1)`` without each point itself. The points are
    queried along a Morton curve, which takes a third of the time for points in random order.

    points: (N, 3) float, N > 0. k: number of neighbours, reduced to N - 1. map: maps over blocks of
    points, in threads.
    """
    from scipy.spatial import cKDTree

    k = min(k, len(points) - 1)
    order = morton_order(points)
    ordered, numbers = points[order], order.astype(np.int32)
    tree, ranks = cKDTree(ordered, LEAF_SIZE, balanced_tree=False), np.arange(1, k + 2)
    shape = len(points), k
    neighbors = Neighbors(np.empty(shape, np.int32), np.empty(shape, np.float32))

    def query(part: slice) -> None:
        distances, nearest = tree.query(ordered[part], ranks)
        # Among duplicates, a point may not be its own first neighbour: move it to the first column.
        own = np.arange(part.start, part.start + len(nearest))
        duplicates = np.flatnonzero(nearest[:, 0] != own)
        column = np.argmax(nearest[duplicates] == own[duplicates, None], axis=1)
        nearest[duplicates, column] = nearest[duplicates, 0]
        neighbors.indices[order[part]] = numbers.take(nearest[:, 1:])
        neighbors.distances[order[part]] = distances[:, 1:]

    list(map(query, blocks(len(points))))
    return neighbors


def blocks(count: int) -> list[slice]:
    """Slices of `count` points in blocks that fit into the processor's cache."""
    return [slice(begin, begin + BLOCK_SIZE) for begin in range(0, count, BLOCK_SIZE)]


def point_spacing(points: Points) -> float:
    """Median distance from (N, 3) points to their nearest neighbours; 0 for N < 2."""
    return nearest_neighbors(points, 1).spacing if len(points) > 1 else 0.0


def interpolate(points: Points, samples: Points, values: Points, k: int) -> NDArray[np.float64]:
    """Interpolate values of samples by inverse distance weighting of the k nearest (Shepard 1968).

    points, samples, values: (n, 3), (m, 3) and (m, ...) float.
    k: number of samples that contribute to a value, reduced to m. Returns (n, ...) float64.
    """
    from scipy.spatial import cKDTree

    distances, nearest = cKDTree(samples).query(points, k=[*range(1, min(k, len(samples)) + 1)])
    weights = 1.0 / np.maximum(distances, 1e-9 * (distances.max() + 1e-30))
    weights /= weights.sum(axis=1, keepdims=True)
    return np.asarray(np.einsum("nk,nk...->n...", weights, values[nearest]))


def principal_spreads(points: NDArray[np.float64], radius: float) -> NDArray[np.float64]:
    """Standard deviations along the principal axes of the ball of points around each point.

    points: (N, 3) float64.
    radius: of the balls, in the unit of the points.

    Returns (N, 3) in ascending order. In a rod the first two are small, on a sheet the first.
    """
    from scipy.sparse import csr_matrix
    from scipy.spatial import cKDTree

    count, centered = len(points), points - points.mean(axis=0)
    i, j = cKDTree(points).query_pairs(radius, output_type="ndarray").T
    half = csr_matrix((np.ones(len(i)), (i, j)), (count, count))
    products = (centered[:, :, None] * centered[:, None]).reshape(count, 9)
    moments = np.column_stack([np.ones(count), centered, products])
    sums = moments + half @ moments + half.T @ moments  # over each ball
    mean, squares = np.split(sums[:, 1:] / sums[:, :1], [3], axis=1)
    covariance = squares.reshape(count, 3, 3) - mean[:, :, None] * mean[:, None]
    return np.sqrt(np.maximum(np.linalg.eigvalsh(covariance), 0.0))
