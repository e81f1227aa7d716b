"""What is computed of all points at once is that of each point by itself."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from traits import surface
from traits.neighbors import NEIGHBORS, nearest_neighbors
from traits.smooth import FRAME_NEIGHBORS, PATCH_SIZES, RIDGE, fit_patches


def bent_sheet(count: int = 400) -> np.ndarray:
    """Noisy points of a sheet that is bent more one way than the other."""
    rng = np.random.default_rng(0)
    x, y = rng.uniform(-1, 1, (2, count)) * [[2.0], [1.0]]
    return np.stack([x, y, 0.3 * x**2 - 0.1 * x * y + rng.normal(0, 0.02, count)], axis=1)


def tangent_frame(near: np.ndarray) -> np.ndarray:
    """(3, 3) principal axes of the neighbours, the columns, the normal first."""
    return np.linalg.eigh(np.cov(near.T, bias=True))[1]


def paraboloid(point: np.ndarray, near: np.ndarray, size: int) -> tuple[float, float, float]:
    """Height over the point, mean squared residual, share of the noise variance that is left."""
    distance = np.linalg.norm(near - point, axis=1)
    widest, radius = distance[-1], distance[size - 1]
    z, x, y = ((near - point) @ tangent_frame(near[:FRAME_NEIGHBORS]) / widest).T
    terms = np.stack([np.ones_like(x), x, y, x**2, x * y, y**2], axis=1)[:size]
    weight = np.exp(-((distance[:size] / radius) ** 2))
    ridge = np.diag(RIDGE * (radius / widest) ** [0, 2, 2, 4, 4, 4])
    inverse = np.linalg.inv((terms.T * weight) @ terms + ridge)
    height = inverse @ (terms.T * weight) @ z[:size]
    misfit = (weight * (z[:size] - terms @ height) ** 2).sum()
    twice = (terms.T * weight**2) @ terms
    free = weight.sum() - (inverse * twice).sum()
    left = inverse[0] @ twice @ inverse[0]
    return height[0] * widest, misfit / free * widest**2, left


def test_paraboloids_are_weighted_least_squares():
    cloud = bent_sheet()
    points = cloud[::40]
    neighbors = cKDTree(cloud).query(points, k=PATCH_SIZES[-1])[1]
    patches = fit_patches(points, cloud)
    for i, point in enumerate(points):
        near = cloud[neighbors[i]]
        normal = tangent_frame(near[:FRAME_NEIGHBORS])[:, 0]
        side = np.sign(normal @ patches.normals[i])
        assert patches.normals[i] == pytest.approx(side * normal, abs=1e-6)
        height, residual, left = np.array([paraboloid(point, near, n) for n in PATCH_SIZES]).T
        assert patches.height[:, i] == pytest.approx(side * height, rel=1e-6, abs=1e-9)
        assert patches.residual[:, i] == pytest.approx(residual, rel=1e-6, abs=1e-9)
        assert patches.remaining[:, i] == pytest.approx(left, rel=1e-6, abs=1e-9)


def test_cells_end_half_way_to_the_neighbours():
    sheet, variance = bent_sheet(), 1e-4
    cloud = np.vstack(
        [sheet, sheet[::40] + np.array([0.01, 0.0, 0.1])]
    )  # some points of another sheet
    distance, neighbors = (found[:, 1:] for found in cKDTree(cloud).query(cloud, k=NEIGHBORS + 1))
    turns = (np.arange(surface.DIRECTIONS) + 0.5) * 2 * np.pi / surface.DIRECTIONS
    directions = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    _, cells = surface._cells(cloud, nearest_neighbors(cloud), variance)
    for i in range(0, len(sheet), 40):
        near = cloud[neighbors[i]]
        axes = tangent_frame(near[: surface.FRAME_NEIGHBORS])[:, 1:]
        flat = (near - cloud[i]) @ axes
        length = np.linalg.norm(flat, axis=1)
        is_beside = length > 0.5 * distance[i]
        reach = np.sqrt(np.maximum(distance[i] ** 2 - variance, length**2))
        places = (flat * (reach / length)[:, None])[is_beside]
        bounds = 2.0 * places @ directions.T / (places**2).sum(axis=1, keepdims=True)
        expected = 1.0 / np.maximum(bounds.max(axis=0), 1e-3 / distance.max())
        # The axes of the plane may point the other way.
        turned = [np.roll(each, k) for each in (expected, expected[::-1]) for k in (0, 8, 16, 24)]
        assert min(np.abs(cells[i] - each).max() for each in turned) < 1e-6
