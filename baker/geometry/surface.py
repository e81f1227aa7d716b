"""Estimate the surface normal at every point, and the area that the point represents."""

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import knn_graph
from baker.geometry.neighbors import Neighbors, blocks
from baker.geometry.parallel import MapLike

Floats = NDArray[np.floating]

# docs/method.md, "Density".
PLANAR_RATIO = 1.5  # greatest ratio of a neighbourhood's area to its spread; higher on a rod
MAX_AREA_QUANTILE = 0.98  # of the areas of all points, to which larger ones are reduced
MIN_CURVATURE = 0.125  # squared, in middle variances; less of it turns normals of stems less
TINY = float(np.finfo(float).tiny)  # keeps divisors from being 0


def normals_and_areas(
    points: Floats, neighbors: Neighbors, map: MapLike = map
) -> tuple[NDArray[np.uint8], Floats]:
    """The `surface_normals` and the `point_area` of (N, 3) points, from the same covariances."""
    covariance = covariances(points, neighbors, map)
    area = point_area(covariance, neighbors)
    return surface_normals(points, covariance, neighbors, map), area


def covariances(points: Floats, neighbors: Neighbors, map: MapLike = map) -> Floats:
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


def point_area(covariance: Floats, neighbors: Neighbors) -> Floats:
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
    points: Floats, covariance: Floats, neighbors: Neighbors, map: MapLike = map
) -> NDArray[np.uint8]:
    """(N, 2) octahedral codes of normals of planes fitted to the neighbourhood of each point.

    The covariance is averaged over the neighbours, which makes the normals as smooth as with three
    times as many neighbours, without another query. The sign of a normal is arbitrary.

    On stems as thin as a neighbourhood, its smaller two variances are alike, and no plane fits.
    There the normal follows the surface's curvature: the difference between positions that are
    averaged over the neighbours once and twice.

    covariance: (6, N) of the (N, 3) points, as `covariances` returns it.

    References
    ----------
    Hoppe et al. 1992, "Surface reconstruction from unorganized points".
    Desbrun et al. 1999, "Implicit fairing of irregular meshes using diffusion and curvature flow".
    """
    count, k = neighbors.indices.shape
    codes = np.zeros((count, 2), np.uint8)
    if k < 3:
        return codes
    adjacency = knn_graph(neighbors)
    adjacency.data[:] = 1.0
    moments = np.ascontiguousarray(np.concatenate([covariance, points.T]).T)
    averaged = (moments + adjacency @ moments) / (k + 1)
    mean, positions = averaged[:, :6].T, averaged[:, 6:]
    curvature = (positions - (positions + adjacency @ positions) / (k + 1)).T

    def compute(part: slice) -> None:
        # The variance along the curvature is reduced, so that the axis of the smallest one turns
        # to it: on stems, where this variance and the middle one are alike, but hardly on sheets.
        smallest, middle, _ = np.maximum(_eigenvalues(mean[:, part]), TINY)
        x, y, z = curvature[:, part]
        squared = np.maximum(x * x + y * y + z * z, MIN_CURVATURE * middle)
        weight = np.minimum(smallest / middle, 1.0) ** 3 * middle / squared
        products = np.array([x * x, y * y, z * z, x * y, y * z, z * x])
        codes[part] = octahedral(_minor_axes(mean[:, part] - weight * products))

    list(map(compute, blocks(count)))
    return codes


def _eigenvalues(covariance: Floats) -> Floats:
    """(3, N) eigenvalues in ascending order.

    Equivalent to ``np.linalg.eigvalsh``, which takes five times as long (O. K. Smith: Eigenvalues
    of a symmetric 3 x 3 matrix, 1961).
    """
    mean, (xy, yz, zx) = covariance[:3].mean(axis=0), covariance[3:]
    x, y, z = covariance[:3] - mean
    squares = x**2 + y**2 + z**2 + 2 * (xy**2 + yz**2 + zx**2)
    scale = np.maximum(np.sqrt(squares / 6), TINY)
    determinant = x * (y * z - yz**2) - xy * (xy * z - yz * zx) + zx * (xy * yz - y * zx)
    angle = np.arccos(np.clip(determinant / np.maximum(2 * scale**3, TINY), -1, 1)) / 3
    return mean + 2 * scale * np.cos(angle + np.array([[2.0], [4.0], [0.0]]) * np.pi / 3)


def _minor_axes(covariance: Floats) -> Floats:
    """(N, 3) eigenvectors of the smallest eigenvalue, of any length; z if all are equal."""
    # Minus the eigenvalue, the matrix has rank two: cross products of its rows are eigenvectors.
    (x, y, z), (xy, yz, zx) = covariance[:3] - _eigenvalues(covariance)[0], covariance[3:]
    rows = np.array([[x, xy, zx], [xy, y, yz], [zx, yz, z]])
    products = np.cross(rows[[1, 2, 0]], rows[[2, 0, 1]], axis=1)
    longest = np.abs(np.diagonal(products)).argmax(axis=1)
    axes = products[longest, :, np.arange(len(longest))]
    return np.where(axes.any(axis=1, keepdims=True), axes, (0.0, 0.0, 1.0))


def octahedral(normals: Floats) -> NDArray[np.uint8]:
    """(N, 2) hemi-octahedral codes of (N, 3) normals of any length (Cigolle et al. 2014)."""
    upward = normals * np.where(normals[:, 2:] < 0, -1, 1)
    x, y = upward[:, :2].T / np.abs(normals).sum(axis=1)
    return np.round(127.5 + 127.5 * np.column_stack([x + y, x - y])).astype(np.uint8)
