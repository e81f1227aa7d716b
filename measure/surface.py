"""The surface that scanned points lie on: freed from noise, and its area."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]

PATCH = 24  # neighbours that a patch of surface is fitted to
CHART = 24  # neighbours that may hide a place from a point
PROBES = 64  # places about each point at which the surface is looked for
NARROW, WIDE = 1.2, 2.2  # radii of the discs, in mean distances between points


def smoothed(points: Points) -> Points:
    """(N, 3) points brought onto a paraboloid fitted to their neighbours: moving least squares
    (Alexa et al. 2003, "Computing and rendering point set surfaces").

    A plane would do for leaves, but shrinks stems. Fewer than 12 points stay as they are.
    """
    from scipy.spatial import cKDTree

    if len(points) < 12:
        return points
    distance, neighbors = cKDTree(points).query(points, k=min(PATCH, len(points)))
    reach = np.maximum(distance[:, -1:], np.finfo(float).tiny)
    offsets = (points[neighbors] - points[:, None]) / reach[..., None]
    normal, first, second = _axes(offsets)
    x, y, z = (np.einsum("nki,ni->nk", offsets, axis) for axis in (first, second, normal))
    weights = np.exp(-2.0 * (distance / reach) ** 2)
    terms = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], -1) * weights[..., None]
    # The small diagonal keeps patches solvable whose points lie on a line.
    gram = np.einsum("nki,nkj->nij", terms, terms) + np.diag([1e-9, 1e-9, 1e-9, 1e-3, 1e-3, 1e-3])
    right = np.einsum("nki,nk->ni", terms, z * weights)
    height = np.linalg.solve(gram, right[..., None])[:, 0, 0]
    return points + (height[:, None] * reach) * normal


def area(points: Points) -> float:
    """The area of the surface that (N, 3) points were scattered on at random, N of 12 or more.

    Discs about the points cover most of the surface and reach a little over its border. Of a disc
    about a point counts what is nearer to it than to any other point, so each place counts once.
    For discs of radius R about points of density λ, a surface of area A and border B is covered by

        A c(R) + B s(R),    c = 1 - exp(-λ π R²),

    where s is the strip gained beyond the border less what is missed within it. Two radii give two
    equations for A and B. They are large enough for points that lie more evenly, as scanners' do.
    Gives 0 for fewer points.
    """
    if len(points) < 12:
        return 0.0
    distance, flat = _charts(points)
    # In a plane the sixth neighbour is 1.343 / √λ away in the median.
    unit = float(np.median(distance[:, 5])) / 1.343
    if unit <= 0.0:
        return 0.0
    radii = (NARROW * unit, WIDE * unit)
    covered = [_covered(flat, radius) for radius in radii]
    found = covered[0]
    for _ in range(12):
        density = len(points) / found
        system = [[1.0 - np.exp(-density * np.pi * r * r), _strip(r, density)] for r in radii]
        found = max(float(np.linalg.solve(system, covered)[0]), 0.3 * covered[0])
    return found


def _axes(offsets: NDArray[np.float64]) -> tuple[Points, Points, Points]:
    """(N, 3) each: the normal, and two directions along, of N neighbourhoods (N, k, 3)."""
    about = offsets - offsets.mean(axis=1, keepdims=True)
    _, axes = np.linalg.eigh(np.einsum("nki,nkj->nij", about, about))
    return axes[:, :, 0], axes[:, :, 2], axes[:, :, 1]


def _charts(points: Points) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Each point's neighbours laid flat about it: their distances (N, k), and (N, k, 2).

    Directions are those in the tangent plane, distances those in space: on a thin stem a plain
    projection would draw its sides together. What stands on the plane is another sheet: far away.
    """
    from scipy.spatial import cKDTree

    distance, neighbors = cKDTree(points).query(points, k=min(CHART, len(points) - 1) + 1)
    distance, neighbors = distance[:, 1:], neighbors[:, 1:]
    offsets = points[neighbors] - points[:, None]
    _, first, second = _axes(offsets[:, :12])
    flat = np.stack([np.einsum("nki,ni->nk", offsets, axis) for axis in (first, second)], -1)
    length = np.linalg.norm(flat, axis=2)
    flat *= (distance / np.maximum(length, np.finfo(float).tiny))[..., None]
    flat[length <= 0.5 * distance] = 1e6 * max(float(distance.max()), 1e-30)
    return distance, flat


def _covered(flat: NDArray[np.float64], radius: float) -> float:
    """The area within `radius` of any point, each place at its nearest point."""
    number = np.arange(PROBES) + 0.5
    angle, away = number * np.pi * (3.0 - np.sqrt(5.0)), np.sqrt(number / PROBES)
    probes = radius * away[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    share = 0.0
    for first in range(0, len(flat), 512):
        other = flat[first : first + 512]
        # |p - q|² < |p|²  is  |q|² < 2 p·q
        nearer = (other**2).sum(axis=2)[..., None] < 2.0 * other @ probes.T
        share += float((~nearer.any(axis=1)).mean(axis=1).sum())
    return share * np.pi * radius**2


def _strip(radius: float, density: float) -> float:
    """Width of what discs about random points gain beyond a straight border, less what is missed
    inside it for want of points beyond.
    """
    away = np.linspace(0.0, radius, 128)
    beyond = radius**2 * np.arccos(away / radius) - away * np.sqrt(radius**2 - away**2)
    whole = np.pi * radius**2
    gained = 1.0 - np.exp(-density * beyond)
    missed = np.exp(-density * (whole - beyond)) - np.exp(-density * whole)
    height = gained - missed
    return float((height[1:] + height[:-1]).sum() / 2.0 * (away[1] - away[0]))
