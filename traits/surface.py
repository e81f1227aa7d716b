"""Estimate the area of the surface from which points were sampled."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from traits.neighbors import Neighbors
from traits.smooth import tangent_frames

Points = NDArray[np.float64]

FRAME_NEIGHBORS = 12  # to which its tangent plane is fitted
DIRECTIONS = 32  # number of directions in which the extent of a cell is measured
# Radii of discs, and widths of the strip by which the union of such discs exceeds a border, both in
# mean point distances: for uniformly random points (by integration), and for evenly spaced points
# (measured on quasi-random and on Poisson-disc samples, which hardly differ).
DISC_RADII = np.array([1.2, 2.2])
RANDOM_STRIP, EVEN_STRIP = np.array([0.601, 1.729]), np.array([0.731, 1.814])
# Share of a disc of half a mean point distance that is in its own Voronoi cell, for both.
RANDOM_OWN_SHARE, EVEN_OWN_SHARE = 0.699, 0.831
# Width, in mean point distances, by which the border recedes half-way between two scans, as points
# on the border rarely move to points on the border. Measured on leaves that don't move.
MIXING_INSET = 0.06
MIN_POINTS_FOR_AREA = 12  # of an organ
MIN_AREA_RATIO = 0.3  # least area : that of the union of the smaller discs
MAX_ITERATIONS, MIN_CHANGE = 12, 1e-7  # of the area; relative change of the point distance


class Surface(NamedTuple):
    """A surface from which points were sampled."""

    area: float  # in the squared unit of the points
    border: float  # share of the points at a border; if it is large, the area is uncertain


def surface_of(
    points: Points, neighbors: Neighbors, variance: float = 0.0, mixed: float = 0.0
) -> Surface:
    """Estimate the area of the surface that points were sampled from.

    The union of discs around the points covers most of the surface and exceeds its border a little.
    Each disc is clipped to the Voronoi cell of its point, so that nothing counts twice. Discs of
    radius R around points of density λ cover, of a surface of area A with border length B,

        A c(R) + B s(R),    c = 1 - exp(-λ π R²) for random points, 1 for evenly spread ones,

    where s is the width of the strip covered beyond the border minus that missed within it. Two
    radii give two equations for A and B. The overlap of small discs measures how even points are.

    Parameters
    ----------
    points : ndarray of shape (N, 3)
    neighbors : Neighbors
        Of the points.
    variance : float
        Variance of the noise that remains in the distance between neighbours.
    mixed : float
        0 if all points come from one scan, 1 if half of them come from each of two.

    Returns
    -------
    Surface
        With area 0 for fewer than 12 points.
    """
    if len(points) < MIN_POINTS_FOR_AREA:
        return Surface(0.0, 1.0)
    unit, cells = _cells(points, neighbors, variance)
    if unit <= 0.0:
        return Surface(0.0, 1.0)

    def covered(radius: float) -> float:
        """The area of the union of discs, each clipped to the cell of its point."""
        return float((np.minimum(cells, radius) ** 2).sum()) * np.pi / DIRECTIONS

    area = covered(DISC_RADII[0] * unit)
    min_area = MIN_AREA_RATIO * area
    for _ in range(MAX_ITERATIONS):
        previous, unit = unit, float(np.sqrt(area / len(points)))
        if abs(unit - previous) < MIN_CHANGE * unit:
            break
        own_share = covered(0.5 * unit) / (len(points) * np.pi * (0.5 * unit) ** 2)
        evenness = (own_share - RANDOM_OWN_SHARE) / (EVEN_OWN_SHARE - RANDOM_OWN_SHARE)
        evenness = np.clip(evenness, 0.0, 1.0)
        inside = 1.0 - (1.0 - evenness) * np.exp(-np.pi * DISC_RADII**2)
        strip = (1.0 - evenness) * RANDOM_STRIP + evenness * EVEN_STRIP - mixed * MIXING_INSET
        areas = [covered(radius * unit) for radius in DISC_RADII]
        area = max(float(np.linalg.solve(np.column_stack([inside, strip]), areas)[0]), min_area)
    border = (cells > DISC_RADII[1] * unit).any(axis=1)
    return Surface(area, float(border.mean()))


def _cells(
    points: Points, neighbors: Neighbors, variance: float
) -> tuple[float, NDArray[np.float64]]:
    """Approximate mean point distance, and (N, DIRECTIONS) extents of the Voronoi cells.

    Neighbours are placed in the tangent plane at their direction and their distance in space, since
    a projection would reduce the width of thin stems. Neighbours in a direction near the normal
    belong to another surface and are ignored.
    """
    distance, indices = neighbors
    offsets = points[indices] - points[:, None]
    flat = (offsets @ tangent_frames(offsets[:, :FRAME_NEIGHBORS]))[..., 1:]
    length = np.linalg.norm(flat, axis=2)
    flat[length <= 0.5 * distance] = 0.0
    angle = (np.arange(DIRECTIONS) + 0.5) * 2.0 * np.pi / DIRECTIONS
    # A neighbour at q bounds the cell where |p|² = |p - q|²: in direction w at |q|² / 2 w·q.
    size = length * np.sqrt(np.maximum(distance**2 - variance, length**2))
    bounds = 2.0 * flat / np.maximum(size, 1e-300)[..., None] @ [np.cos(angle), np.sin(angle)]
    unbounded = 1e3 * max(float(distance.max()), 1e-30)  # where there is no neighbour
    cells = 1.0 / np.maximum(bounds.max(axis=1), 1.0 / unbounded)
    # The median distance to the sixth neighbour in a plane is 1.343 / √λ.
    return float(np.median(distance[:, min(5, distance.shape[1] - 1)])) / 1.343, cells
