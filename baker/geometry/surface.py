"""Estimate the surface normal at every point, and the area that the point represents."""

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import Neighbors, blocks

PLANAR_RATIO = 1.5  # greatest area : spread of a neighbourhood; it is higher on a thin rod
MAX_AREA_QUANTILE = 0.98  # of the areas of all points, to which larger ones are reduced


def normals_and_areas(
    points: NDArray[np.floating], neighbors: Neighbors
) -> tuple[NDArray[np.uint8], NDArray[np.float64]]:
    """The `surface_normals` and the `point_area` of points, from the same covariances.

    Parameters
    ----------
    points : (N, 3) float
    neighbors : Neighbors
        Of the points.

    Returns
    -------
    normals : (N, 2) uint8
        Octahedral codes (docs/format.md, "Normals"), without the sign of the normal.
    area : (N,) float64
        In squared length units, up to a common factor; 1 for a single point.

    References
    ----------
    Hoppe et al. 1992, "Surface reconstruction from unorganized points".
    """
    covariance = covariances(points, neighbors)
    return surface_normals(covariance, neighbors), point_area(covariance, neighbors)


def covariances(points: NDArray[np.floating], neighbors: Neighbors) -> NDArray[np.float64]:
    """(N, 3, 3) covariance of the positions of each of (N, 3) points and its neighbours."""
    covariance = np.empty((len(points), 3, 3))
    count = neighbors.indices.shape[1] + 1
    for part in blocks(len(points)):
        # That of the point itself is 0.
        offsets = points[neighbors.indices[part]].astype(np.float64) - points[part, None]
        mean = offsets.sum(axis=1) / count
        products = offsets.transpose(0, 2, 1) @ offsets / count
        covariance[part] = products - mean[:, :, None] * mean[:, None]
    return covariance


def point_area(covariance: NDArray[np.float64], neighbors: Neighbors) -> NDArray[np.float64]:
    """(N,) area of the surface that each point represents, up to a common factor.

    On a surface it is the squared distance to the last neighbour. On a twig thinner than the point
    spacing, it is limited by the area of a disk with the same covariance as the neighbourhood. The
    area of isolated points is limited by a quantile of all.
    """
    if not neighbors.indices.size:
        return np.ones(len(neighbors.indices))
    area = neighbors.distances[:, -1].astype(np.float64) ** 2
    # The sum of the products of two principal variances, on a sheet that of the larger two. Both
    # are a quarter of the squared radius on a uniform disk.
    trace = np.trace(covariance, axis1=1, axis2=2)
    products = (trace**2 - (covariance**2).sum(axis=(1, 2))) / 2.0
    spread = 4.0 * np.sqrt(np.maximum(products, 0.0))
    area = np.minimum(area, PLANAR_RATIO * spread)
    return np.minimum(area, np.quantile(area, MAX_AREA_QUANTILE))


def surface_normals(covariance: NDArray[np.float64], neighbors: Neighbors) -> NDArray[np.uint8]:
    """(N, 2) octahedral codes of the normals of planes fitted to the neighbourhood of each point.

    The covariance is averaged over the neighbours, which makes the normals as smooth as with three
    times as many neighbours, without another query.
    """
    codes = np.zeros((len(covariance), 2), np.uint8)
    if neighbors.indices.shape[1] >= 3:
        for part in blocks(len(covariance)):
            smooth = covariance[part] + covariance[neighbors.indices[part]].sum(axis=1)
            codes[part] = octahedral(np.linalg.eigh(smooth)[1][:, :, 0])
    return codes


def octahedral(normals: NDArray[np.floating]) -> NDArray[np.uint8]:
    """(N, 2) hemi-octahedral codes of (N, 3) normals of any length (Cigolle et al. 2014)."""
    upward = normals * np.where(normals[:, 2:] < 0, -1, 1)
    x, y = upward[:, :2].T / np.abs(normals).sum(axis=1)
    return np.round(127.5 + 127.5 * np.column_stack([x + y, x - y])).astype(np.uint8)
