"""The area of the surface that scanned points lie on."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from traits.smooth import axes_of

Points = NDArray[np.float64]

CHART = 24  # neighbours that may hide a place from a point
FLAT = 12  # of them, those that say which way a surface lies
WAYS = 32  # about each point in which its cell is measured
# Radii of discs in mean distances between points, and the width of the strip that their union
# gains beyond a border: of points at random (the integral of what no disc covers), and evenly
# spread ones (quasi-random, or kept apart: measured, they hardly differ).
RADII = np.array([1.2, 2.2])
RANDOM_STRIP, EVEN_STRIP = np.array([0.601, 1.729]), np.array([0.731, 1.814])
# Share of discs of half a mean distance that lies in no other such disc's place, likewise.
RANDOM_ALONE, EVEN_ALONE = 0.699, 0.831
# How far inside a border points half of one scan and half of another lie, in mean distances: one
# on the border goes to one that is seldom as near to it. Measured on leaves that stood still.
INSIDE = 0.06


class Surface(NamedTuple):
    """Its area, and the share of its points that lie at a border: of many, it is hardly seen."""

    area: float
    border: float


def area(points: Points, variance: float = 0.0, mixed: float = 0.0) -> float:
    """See `surface_of`."""
    return surface_of(points, variance, mixed).area


def surface_of(points: Points, variance: float = 0.0, mixed: float = 0.0) -> Surface:
    """The surface that (N, 3) points were scattered on; of area 0 for fewer than 12.

    Discs about the points cover most of the surface and reach a little over its border. Of a disc
    about a point counts what is nearer to it than to any other point, its cell, so each place
    counts once. Discs of radius R about points of density λ cover, of an area A with border B,

        A c(R) + B s(R),    c = 1 - exp(-λ π R²) for points at random, 1 for even ones,

    where s is the width gained beyond the border less what is missed within it. Two radii give two
    equations for A and B. How evenly points lie, small discs tell by how little they overlap.

    variance: of the noise across the surface, which makes points seem farther apart. Neighbours
              share half of what smoothing left of it.
    mixed:    how much of the points is of one scan and how much of another, 0 to 1.
    """
    if len(points) < 12:
        return Surface(0.0, 1.0)
    unit, cells = _cells(points, variance)
    if unit <= 0.0:
        return Surface(0.0, 1.0)

    def covered(radius: float) -> float:
        return float((np.minimum(cells, radius) ** 2).sum()) * np.pi / WAYS

    least = 0.3 * covered(RADII[0] * unit)
    found = covered(RADII[0] * unit)
    for _ in range(12):
        unit = float(np.sqrt(found / len(points)))
        alone = covered(0.5 * unit) / (len(points) * np.pi * (0.5 * unit) ** 2)
        even = np.clip((alone - RANDOM_ALONE) / (EVEN_ALONE - RANDOM_ALONE), 0.0, 1.0)
        inside = 1.0 - (1.0 - even) * np.exp(-np.pi * RADII**2)
        strip = (1.0 - even) * RANDOM_STRIP + even * EVEN_STRIP - mixed * INSIDE
        both = [covered(radius * unit) for radius in RADII]
        found = max(float(np.linalg.solve(np.column_stack([inside, strip]), both)[0]), least)
    border = (cells > RADII[1] * unit).any(axis=1)
    return Surface(found, float(border.mean()))


def _cells(points: Points, variance: float) -> tuple[float, NDArray[np.float64]]:
    """The mean distance between points, roughly, and how far each one's Voronoi cell reaches in
    evenly spread directions, (N, WAYS), its neighbours laid flat about it.

    Directions are those in the tangent plane, distances those in space: on a thin stem a plain
    projection would draw its sides together. What stands on the plane is another sheet: far away.
    """
    from scipy.spatial import cKDTree

    distance, neighbors = cKDTree(points).query(points, k=min(CHART, len(points) - 1) + 1)
    distance, neighbors = distance[:, 1:], neighbors[:, 1:]
    angle = (np.arange(WAYS) + 0.5) * 2.0 * np.pi / WAYS
    ways = np.stack([np.cos(angle), np.sin(angle)])
    cells = np.empty((len(points), WAYS))
    far = 1e3 * max(float(distance.max()), 1e-30)
    for first in range(0, len(points), 512):
        part = slice(first, first + 512)
        offsets = points[neighbors[part]] - points[part, None]
        _, *along = axes_of(offsets[:, :FLAT])
        flat = np.stack([np.einsum("nki,ni->nk", offsets, axis) for axis in along], -1)
        length = np.linalg.norm(flat, axis=2)
        apart = np.sqrt(np.maximum(distance[part] ** 2 - variance, length**2))
        flat *= (apart / np.maximum(length, 1e-300))[..., None]
        flat[length <= 0.5 * distance[part]] = far
        # A neighbour at q ends the cell where |p|² = |p - q|², in direction w at |q|² / 2 w·q.
        toward = flat @ ways
        ends = (flat**2).sum(axis=2)[..., None] / (2.0 * np.maximum(toward, 1e-9 * far))
        cells[part] = np.where(toward > 0.0, ends, far).min(axis=1)
    # In a plane the sixth neighbour is 1.343 / √λ away in the median.
    return float(np.median(distance[:, min(5, distance.shape[1] - 1)])) / 1.343, cells
