"""The surface around every point of a cloud: its normal, and the area that the point stands for."""

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import Neighbors, blocks

PLANAR_RATIO = 1.5  # squared reach over spread from which on points lie on a thin rod
MAX_AREA_QUANTILE = 0.98  # of all points' areas, that none exceeds


def normals_and_areas(
    points: NDArray[np.floating], neighbors: Neighbors
) -> tuple[NDArray[np.uint8], NDArray[np.float64]]:
    """Normals of the surface and the area that each point stands for, of one covariance.

    Parameters
    ----------
    points, neighbors : (N, 3) float, Neighbors

    Returns
    -------
    (N, 2) uint8 and (N,) float64, as of `surface_normals` and `point_area`
    """
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
    for part in blocks(len(points)):
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

    covariance: (6, N), as of `covariances`. Returns (N,) in squared units of the points; 1 where a
    cloud has but one point.
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

    covariance: (6, N), as of `covariances`. Returns (N, 2) octahedral codes (docs/format.md,
    "Normals"); a plane's two sides are alike.

    References
    ----------
    Hoppe et al. 1992, "Surface reconstruction from unorganized points".
    """
    from scipy.sparse import csr_matrix

    count, k = neighbors.indices.shape
    codes = np.zeros((count, 2), np.uint8)
    if k < 3:
        return codes
    for part in blocks(count):
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
