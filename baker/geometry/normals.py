"""The surface's normal at every point of a cloud, in the two bytes that a clip has for it."""

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import POINTS_AT_ONCE, Neighbors


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
    around = np.column_stack([np.arange(len(points)), neighbors.indices])
    parts = np.array_split(np.arange(len(points)), -(-len(points) // POINTS_AT_ONCE))
    spread = np.empty((len(points), 3, 3))
    for part in parts:
        near = points[around[part]].astype(np.float64)
        near -= near.mean(axis=1, keepdims=True)
        spread[part] = near.transpose(0, 2, 1) @ near
    normals = [np.linalg.eigh(spread[around[part]].sum(axis=1))[1][..., 0] for part in parts]
    return octahedral(np.concatenate(normals))


def octahedral(normals: NDArray[np.floating]) -> NDArray[np.uint8]:
    """(N, 2) codes of (N, 3) normals of any length (Cigolle et al. 2014, hemi-octahedral)."""
    upward = normals * np.where(normals[:, 2:] < 0, -1, 1)
    x, y = upward[:, :2].T / np.abs(normals).sum(axis=1)
    return np.round(127.5 + 127.5 * np.column_stack([x + y, x - y])).astype(np.uint8)
