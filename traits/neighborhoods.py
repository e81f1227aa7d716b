"""Tangent frames, paraboloids and Voronoi cells of points, from their nearest neighbours."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Indices = NDArray[np.intp]

FRAME_NEIGHBORS = 20  # to which the tangent plane of a paraboloid is fitted
CELL_FRAME_NEIGHBORS = 12  # to which that of a Voronoi cell is fitted
# Regularisation of a paraboloid's terms 1, x, y, x², xy and y², for points on a line.
RIDGE = np.array([1e-9, 1e-9, 1e-9, 1e-3, 1e-3, 1e-3])


def _tangent_frames(neighbors: Floats) -> Floats:
    """(N, 3, 3) principal axes of (N, k, 3) neighbours, as columns, the normal first."""
    centered = neighbors - neighbors.mean(axis=1, keepdims=True)
    return np.linalg.eigh(centered.swapaxes(1, 2) @ centered)[1]


def fit_paraboloids(
    points: Floats, cloud: Floats, neighbors: Indices, distance: Floats, sizes: list[int]
) -> tuple[Floats, Floats]:
    """Fit paraboloids to the nearest neighbours of each point by weighted least squares.

    Parameters
    ----------
    points : ndarray of shape (N, 3)
    cloud : ndarray of shape (M, 3)
        The cloud of the neighbours.
    neighbors, distance : ndarrays of shape (N, k)
        Indices of the neighbours, sorted by distance.
    sizes : list of int
        P numbers of neighbours to fit to, up to k.

    Returns
    -------
    normals : ndarray of shape (N, 3)
        Normals of the tangent planes.
    fits : ndarray of shape (3, P, N)
        Heights of the paraboloids above the points, mean squared residuals, and shares of the noise
        variance that remain in the heights.
    """
    offsets = cloud[neighbors] - points[:, None]
    axes = _tangent_frames(offsets[:, :FRAME_NEIGHBORS])
    local = axes.swapaxes(1, 2) @ offsets.swapaxes(1, 2)
    fits = np.empty((3, len(sizes), len(points)))
    for fit, size in zip(fits.swapaxes(0, 1), sizes, strict=True):
        radius = np.maximum(distance[:, size - 1], 1e-300 + 1e-6 * distance[:, -1])
        weight = np.exp(-((distance[:, :size] / radius[:, None]) ** 2))
        z, x, y = local.swapaxes(0, 1)[..., :size] / radius[:, None]
        terms = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=1)
        weighted = terms * weight[:, None]
        inverse = np.linalg.inv(weighted @ terms.swapaxes(1, 2) + np.diag(RIDGE))
        coefficients = inverse @ (weighted @ z[..., None])
        misfit = (weight * (z - (coefficients.swapaxes(1, 2) @ terms)[:, 0]) ** 2).sum(axis=1)
        twice = weighted @ weighted.swapaxes(1, 2)
        free = weight.sum(axis=1) - (inverse * twice).sum(axis=(1, 2))
        fit[0] = coefficients[:, 0, 0] * radius
        fit[1] = misfit / np.maximum(free, 1e-9) * radius**2
        fit[2] = np.minimum((inverse[:, :1] @ twice @ inverse[:, :, :1])[:, 0, 0], 1.0)
    return axes[..., 0], fits


def measure_cells(
    points: Floats,
    neighbors: Indices,
    distance: Floats,
    variance: float,
    directions: Floats,
    far: float,
) -> Floats:
    """Measure the Voronoi cell of each point in its tangent plane.

    Neighbours are placed in the tangent plane at their direction and their distance in space, since
    a projection would reduce the width of thin stems. Neighbours in a direction near the normal
    belong to another surface and are ignored.

    Parameters
    ----------
    points : ndarray of shape (N, 3)
    neighbors, distance : ndarrays of shape (N, k)
    variance : float
        Variance of the noise in the distance between neighbours.
    directions : ndarray of shape (D, 2)
        Unit vectors.
    far : float
        Extent of cells in directions without a neighbour.

    Returns
    -------
    ndarray of shape (N, D)
        Extents of the cells.
    """
    offsets = points[neighbors] - points[:, None]
    flat = (offsets @ _tangent_frames(offsets[:, :CELL_FRAME_NEIGHBORS]))[..., 1:]
    length = np.linalg.norm(flat, axis=2)
    flat[length <= 0.5 * distance] = 0.0
    # A neighbour at q bounds the cell where |p|² = |p - q|²: in direction w at |q|² / 2 w·q.
    size = length * np.sqrt(np.maximum(distance**2 - variance, length**2))
    bounds = 2.0 * flat / np.maximum(size, 1e-300)[..., None] @ directions.T
    return 1.0 / np.maximum(bounds.max(axis=1), 1.0 / far)
