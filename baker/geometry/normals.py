"""The surface's normal at every point of a cloud, in the two bytes that a clip has for it."""

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import POINTS_AT_ONCE, Neighbors, covariances


def surface_normals(points: NDArray[np.floating], neighbors: Neighbors) -> NDArray[np.uint8]:
    """Fit a plane to what lies around each point.

    The plane is that of the neighbours' covariance, averaged over the neighbours: as smooth as one
    of three times as many, without another query.

    Parameters
    ----------
    points : (N, 3) float ndarray
    neighbors : Neighbors
        Of these points.

    Returns
    -------
    (N, 2) uint8 ndarray
        Octahedral codes (docs/format.md, "Normals"); a plane's two sides are alike.

    References
    ----------
    Hoppe et al. 1992, "Surface reconstruction from unorganized points".
    """
    if neighbors.indices.shape[1] < 3:
        return np.zeros((len(points), 2), np.uint8)
    covariance = covariances(points, neighbors)
    codes = np.empty((len(points), 2), np.uint8)
    for begin in range(0, len(points), POINTS_AT_ONCE):
        part = slice(begin, begin + POINTS_AT_ONCE)
        near = neighbors.indices[part].T.copy()
        mean = np.array([own[part] + own.take(near).sum(axis=0) for own in covariance])
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
