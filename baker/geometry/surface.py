"""Estimate the surface normal at every point, and the area that the point represents."""

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import Neighbors, blocks
from baker.geometry.parallel import MapLike

# docs/method.md, "Density".
PLANAR_RATIO = 1.5  # greatest area : spread of a neighbourhood; it is higher on a thin rod
MAX_AREA_QUANTILE = 0.98  # of the areas of all points, to which larger ones are reduced


def normals_and_areas(
    points: NDArray[np.floating], neighbors: Neighbors, map: MapLike = map
) -> tuple[NDArray[np.uint8], NDArray[np.float64]]:
    """The `surface_normals` and the `point_area` of points, from the same covariances.

    Parameters
    ----------
    points : (N, 3) float
    neighbors : Neighbors
        Of the points.
    map : map-like callable
        Maps over blocks of points, in threads.

    Returns
    -------
    normals : (N, 2) uint8
        Octahedral codes (docs/format.md, "Normals").
    area : (N,) float64
        In squared length units.
    """
    covariance = covariances(points, neighbors, map)
    return surface_normals(covariance, neighbors, map), point_area(covariance, neighbors)


def covariances(
    points: NDArray[np.floating], neighbors: Neighbors, map: MapLike = map
) -> NDArray[np.float64]:
    """(6, N) covariance of the positions of each point and its neighbours, in squared units.

    The elements are xx, yy, zz, xy, yz and zx. Equivalent, for each point with neighbours j, to
    ``np.cov(points[[i, *j]].T, bias=True)``.
    """
    covariance = np.empty((6, len(points)))
    columns = np.ascontiguousarray(points.T, np.float64)

    def compute(part: slice) -> None:
        nearest = neighbors.indices[part].T.copy()  # (k, n), contiguous
        count = len(nearest) + 1
        # The point itself counts, too, with the offset 0.
        offsets = [axis.take(nearest) - axis[part] for axis in columns]
        sums = [axis.sum(axis=0) for axis in offsets]
        for element, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))):
            products = np.einsum("kn,kn->n", offsets[i], offsets[j])
            covariance[element, part] = (products - sums[i] * sums[j] / count) / count

    list(map(compute, blocks(len(points))))
    return covariance


def point_area(covariance: NDArray[np.float64], neighbors: Neighbors) -> NDArray[np.float64]:
    """(N,) area of the surface that each point represents, up to a common factor.

    On a surface it is the squared distance to the last neighbour. On a twig thinner than the point
    spacing, it is limited by the area of a disk with the same covariance as the neighbourhood. The
    area of isolated points is limited by a quantile of all areas; that of a single point is 1.

    covariance: (6, N) as `covariances` returns it.
    """
    if not neighbors.indices.size:
        return np.ones(len(neighbors.indices))
    area = neighbors.distances[:, -1].astype(np.float64) ** 2
    xx, yy, zz, xy, yz, zx = covariance
    # The sum of the products of two principal variances, on a sheet that of the larger two. Both
    # are a quarter of the squared radius on a uniform disk.
    products = xx * yy + yy * zz + zz * xx - xy**2 - yz**2 - zx**2
    spread = 4.0 * np.sqrt(np.maximum(products, 0.0))
    area = np.minimum(area, PLANAR_RATIO * spread)
    return np.minimum(area, np.quantile(area, MAX_AREA_QUANTILE))


def surface_normals(
    covariance: NDArray[np.float64], neighbors: Neighbors, map: MapLike = map
) -> NDArray[np.uint8]:
    """(N, 2) octahedral codes of normals of planes fitted to the neighbourhood of each point.

    The covariance is averaged over the neighbours, which makes the normals as smooth as with three
    times as many neighbours, without another query. The sign of a normal is arbitrary.

    covariance: (6, N) as `covariances` returns it.

    References
    ----------
    Hoppe et al. 1992, "Surface reconstruction from unorganized points".
    """
    from scipy.sparse import csr_matrix

    count, k = neighbors.indices.shape
    codes = np.zeros((count, 2), np.uint8)
    if k < 3:
        return codes
    rows = np.ascontiguousarray(covariance.T)  # one product of all elements takes half the time

    def compute(part: slice) -> None:
        nearest = neighbors.indices[part]
        begins = np.arange(0, nearest.size + 1, k)
        ones = np.ones(nearest.size)
        adjacency = csr_matrix((ones, nearest.ravel(), begins), (len(nearest), count))
        codes[part] = octahedral(_minor_axes((rows[part] + adjacency @ rows).T))

    list(map(compute, blocks(count)))
    return codes


def _minor_axes(covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 3) eigenvectors of the smallest eigenvalue, of any length; z if all are equal.

    Equivalent to ``np.linalg.eigh`` of each matrix, which takes five times as long (O. K. Smith:
    Eigenvalues of a symmetric 3 x 3 matrix, 1961).
    """
    diagonal, (xy, yz, zx) = covariance[:3], covariance[3:]
    x, y, z = diagonal - diagonal.mean(axis=0)
    scale = np.sqrt((x**2 + y**2 + z**2 + 2 * (xy**2 + yz**2 + zx**2)) / 6)
    scale = np.maximum(scale, np.finfo(float).tiny)
    determinant = x * (y * z - yz**2) - xy * (xy * z - yz * zx) + zx * (xy * yz - y * zx)
    angle = np.arccos(np.clip(determinant / (2 * scale**3), -1, 1)) / 3
    x, y, z = (x, y, z) - 2 * scale * np.cos(angle + 2 * np.pi / 3)
    # Minus the eigenvalue, the matrix has rank two: its adjugate's columns are eigenvectors.
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
    """(N, 2) hemi-octahedral codes of (N, 3) normals of any length (Cigolle et al. 2014)."""
    upward = normals * np.where(normals[:, 2:] < 0, -1, 1)
    x, y = upward[:, :2].T / np.abs(normals).sum(axis=1)
    return np.round(127.5 + 127.5 * np.column_stack([x + y, x - y])).astype(np.uint8)
