"""The k nearest neighbours of every point of a cloud, and what is read off them.

One query a scan answers for point spacing, point area, normals, outliers, label cleaning, segment
adjacency and graphs; only normals change when the scan is moved rigidly.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gclip.morton import morton_order

NEIGHBORS = 10  # enough for a point at the border of a segment to see the next segment
NEIGHBORS_FOR_REACH = 8  # a point's reach is the distance to its 8th neighbour
OUTLIER_RATIO = 10.0  # an outlier reaches so many times as far as the median point
PLANAR_RATIO = 1.5  # squared reach over spread from which on points lie on a thin rod
MAX_AREA_QUANTILE = 0.98  # of all points' areas, that none exceeds
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
    for part in _blocks(len(points)):
        distances, nearest = tree.query(ordered[part], ranks, workers=workers)
        # Of points in one place, any may come first: each itself is moved to the first column.
        own = np.arange(part.start, part.start + len(nearest))
        other = np.flatnonzero(nearest[:, 0] != own)
        itself = np.argmax(nearest[other] == own[other, None], axis=1)
        nearest[other, itself] = nearest[other, 0]
        found.indices[order[part]] = numbers.take(nearest[:, 1:])
        found.distances[order[part]] = distances[:, 1:]
    return found


def _blocks(count: int) -> list[slice]:
    """Slices of so many points, which stay in the processor's cache."""
    return [slice(begin, begin + POINTS_AT_ONCE) for begin in range(0, count, POINTS_AT_ONCE)]


def point_spacing(points: NDArray[np.floating]) -> float:
    """Median distance from a point of an (N, 3) cloud to its nearest neighbour; 0 for N < 2."""
    return nearest_neighbors(points, 1).spacing if len(points) > 1 else 0.0


def normals_and_areas(
    points: NDArray[np.floating], neighbors: Neighbors
) -> tuple[NDArray[np.uint8], NDArray[np.float64]]:
    """The surface around each of (N, 3) points: as of `surface_normals` and `point_area`."""
    covariance = covariances(points, neighbors)
    return surface_normals(covariance, neighbors), point_area(covariance, neighbors)


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
    for part in _blocks(len(points)):
        near = neighbors.indices[part].T.copy()  # neighbour by neighbour
        count = len(near) + 1
        offsets = [axis.take(near) - axis[part] for axis in columns]  # the point itself is at 0
        sums = [axis.sum(axis=0) for axis in offsets]
        for element, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))):
            products = np.einsum("kn,kn->n", offsets[i], offsets[j])
            found[element, part] = (products - sums[i] * sums[j] / count) / count
    return found


def point_area(covariance: NDArray[np.float64], neighbors: Neighbors) -> NDArray[np.float64]:
    """Area of the surface that each point stands for, up to a common factor.

    On a surface it is the squared distance to the last neighbor. A twig thinner than its point
    spacing has far less: no more than the area of the disk on which the neighbourhood has the same
    covariance. Isolated points count no more than most others do.

    Parameters
    ----------
    covariance, neighbors : (6, N) float64, Neighbors
        Of the same points, as `covariances` has them.

    Returns
    -------
    (N,) float64, in squared units of the points; 1 where a cloud has but one point.
    """
    if not neighbors.indices.size:
        return np.ones(len(neighbors.indices))
    area = neighbors.distances[:, -1].astype(np.float64) ** 2
    xx, yy, zz, xy, yz, zx = covariance
    # The products of two principal variances, summed: on a sheet that of the larger two. On a
    # disk, evenly covered, each of those is a quarter of the squared radius.
    products = xx * yy + yy * zz + zz * xx - xy**2 - yz**2 - zx**2
    spread = 4.0 * np.sqrt(np.maximum(products, 0.0))
    area = np.minimum(area, PLANAR_RATIO * spread)
    return np.minimum(area, np.quantile(area, MAX_AREA_QUANTILE))


def surface_normals(covariance: NDArray[np.float64], neighbors: Neighbors) -> NDArray[np.uint8]:
    """Normals of planes that are fitted to what lies around each point.

    The plane is that of the neighbours' covariance, averaged over the neighbours: as smooth as one
    of three times as many, without another query.

    Parameters
    ----------
    covariance, neighbors : (6, N) float64, Neighbors
        Of the same points, as `covariances` has them.

    Returns
    -------
    (N, 2) uint8 ndarray
        Octahedral codes (docs/format.md, "Normals"); a plane's two sides are alike.

    References
    ----------
    Hoppe et al. 1992, "Surface reconstruction from unorganized points".
    """
    from scipy.sparse import csr_matrix

    count, k = neighbors.indices.shape
    codes = np.zeros((count, 2), np.uint8)
    if k < 3:
        return codes
    for part in _blocks(count):
        near = neighbors.indices[part]
        begins = np.arange(0, near.size + 1, k)
        sums = csr_matrix((np.ones(near.size), near.ravel(), begins), (len(near), count))
        mean = np.array([element[part] + sums @ element for element in covariance])
        codes[part] = octahedral(_minor_axes(mean))
    return codes


def _minor_axes(covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 3) eigenvectors of the smallest eigenvalue, of any length; upright where all are alike.

    Equivalent to ``np.linalg.eigh`` of each matrix, (6, N), which takes five times as long
    (O. K. Smith: Eigenvalues of a symmetric 3 x 3 matrix, 1961).
    """
    diagonal, (xy, yz, zx) = covariance[:3], covariance[3:]
    x, y, z = diagonal - diagonal.mean(axis=0)
    scale = np.sqrt((x**2 + y**2 + z**2 + 2 * (xy**2 + yz**2 + zx**2)) / 6)
    scale = np.maximum(scale, np.finfo(float).tiny)
    determinant = x * (y * z - yz**2) - xy * (xy * z - yz * zx) + zx * (xy * yz - y * zx)
    angle = np.arccos(np.clip(determinant / (2 * scale**3), -1, 1)) / 3
    x, y, z = (x, y, z) - 2 * scale * np.cos(angle + 2 * np.pi / 3)
    # What is left has rank two: the columns of its adjugate are multiples of the vector.
    adjugate = np.array(
        [
            [y * z - yz**2, yz * zx - xy * z, xy * yz - y * zx],
            [yz * zx - xy * z, x * z - zx**2, xy * zx - x * yz],
            [xy * yz - y * zx, xy * zx - x * yz, x * y - xy**2],
        ]
    )
    longest = np.abs(np.diagonal(adjugate)).argmax(axis=1)
    axes = adjugate[longest, :, np.arange(len(longest))]
    return np.where(axes.any(axis=1, keepdims=True), axes, (0.0, 0.0, 1.0))


def octahedral(normals: NDArray[np.floating]) -> NDArray[np.uint8]:
    """(N, 2) codes of (N, 3) normals of any length (Cigolle et al. 2014, hemi-octahedral)."""
    upward = normals * np.where(normals[:, 2:] < 0, -1, 1)
    x, y = upward[:, :2].T / np.abs(normals).sum(axis=1)
    return np.round(127.5 + 127.5 * np.column_stack([x + y, x - y])).astype(np.uint8)


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
