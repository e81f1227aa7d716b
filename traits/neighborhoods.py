"""Tangent frames, paraboloids and Voronoi cells of points, from their nearest neighbours.

The module is compiled by numba: import it in functions.
"""

from math import exp, sqrt

import numpy as np
from numpy.typing import NDArray

from gclip.compiled import compiled

Floats = NDArray[np.float64]
Indices = NDArray[np.intp]

FRAME_NEIGHBORS = 20  # to which the tangent plane of a paraboloid is fitted
CELL_FRAME_NEIGHBORS = 12  # to which that of a Voronoi cell is fitted
ROTATIONS = 18  # of Jacobi's method: six sweeps are sufficient for a (3, 3) matrix
# The terms of a paraboloid are 1, x, y, x², xy, y²; z is the seventh column of normal equations.
PAIRS = np.array([(a, b) for a in range(7) for b in range(a, 7)])
DEGREES = np.array([0, 1, 1, 2, 2, 2])
RIDGE = np.array([1e-9, 1e-9, 1e-9, 1e-3, 1e-3, 1e-3])  # regularisation, for points on a line


@compiled
def _tangent_frame(cloud: Floats, neighbors: Indices, count: int, axes: Floats) -> None:
    """Principal axes of the first `count` neighbours, as columns of (3, 3), the normal first."""
    mean, spread = np.zeros(3), np.zeros((3, 3))
    for n in range(count):
        for a in range(3):
            mean[a] += cloud[neighbors[n], a] / count
    for n in range(count):
        for a in range(3):
            for b in range(3):
                spread[a, b] += (cloud[neighbors[n], a] - mean[a]) * (
                    cloud[neighbors[n], b] - mean[b]
                )
    for a in range(3):
        for b in range(3):
            axes[a, b] = 1.0 if a == b else 0.0
    for rotation in range(ROTATIONS):
        p, q = rotation % 3 // 2, (rotation % 3 + 3) // 2  # 0 1, 0 2, 1 2
        if spread[p, q] != 0.0:
            half = (spread[q, q] - spread[p, p]) / (2.0 * spread[p, q])
            tangent = 1.0 / (abs(half) + sqrt(half * half + 1.0))
            cosine = 1.0 / sqrt(tangent * tangent + 1.0)
            sine = tangent * cosine if half >= 0.0 else -tangent * cosine
            for a in range(3):
                x, y = spread[a, p], spread[a, q]
                spread[a, p], spread[a, q] = cosine * x - sine * y, sine * x + cosine * y
                x, y = axes[a, p], axes[a, q]
                axes[a, p], axes[a, q] = cosine * x - sine * y, sine * x + cosine * y
            for a in range(3):
                x, y = spread[p, a], spread[q, a]
                spread[p, a], spread[q, a] = cosine * x - sine * y, sine * x + cosine * y
    least = 0
    for a in range(3):
        if spread[a, a] < spread[least, least]:
            least = a
    for a in range(3):
        axes[a, 0], axes[a, least] = axes[a, least], axes[a, 0]


@compiled
def fit_paraboloids(
    points: Floats,
    cloud: Floats,
    neighbors: Indices,
    distance: Floats,
    sizes: Indices,
    normals: Floats,
    fits: Floats,
) -> None:
    """Fit paraboloids to the nearest neighbours of each point by weighted least squares.

    The products of terms, which the normal equations sum up, are computed once for all sizes.

    Parameters
    ----------
    points : ndarray of shape (N, 3)
    cloud : ndarray of shape (M, 3)
        The cloud of the neighbours.
    neighbors, distance : ndarrays of shape (N, k)
        Indices of the neighbours, sorted by distance.
    sizes : ndarray of shape (P,)
        Numbers of neighbours to fit to, ascending up to k.
    normals : ndarray of shape (N, 3)
        Output: normals of the tangent planes.
    fits : ndarray of shape (3, P, N)
        Output: heights of the paraboloids above the points, mean squared residuals, and shares of
        the noise variance that remain in the heights.
    """
    k, count = neighbors.shape[1], len(RIDGE)
    axes, local, terms = np.empty((3, 3)), np.empty(3), np.empty(count + 1)
    products, system = np.empty((k, len(PAIRS))), np.empty((count + 1, count + 1))
    once, twice = np.empty(len(PAIRS)), np.empty(len(PAIRS))  # sums weighted by w and by w²
    for i in range(len(points)):
        _tangent_frame(cloud, neighbors[i], min(FRAME_NEIGHBORS, k), axes)
        least = 1e-300 + 1e-6 * distance[i, k - 1]
        widest = max(distance[i, k - 1], least)
        for a in range(3):
            normals[i, a] = axes[a, 0]
        for n in range(k):
            for b in range(3):
                local[b] = 0.0
                for a in range(3):
                    local[b] += (cloud[neighbors[i, n], a] - points[i, a]) / widest * axes[a, b]
            z, x, y = local[0], local[1], local[2]
            terms[0], terms[1], terms[2] = 1.0, x, y
            terms[3], terms[4], terms[5], terms[6] = x * x, x * y, y * y, z
            for c in range(len(PAIRS)):
                products[n, c] = terms[PAIRS[c, 0]] * terms[PAIRS[c, 1]]
        for j in range(len(sizes)):
            radius = max(distance[i, sizes[j] - 1], least)
            for c in range(len(PAIRS)):
                once[c] = twice[c] = 0.0
            for n in range(sizes[j]):
                weight = exp(-((distance[i, n] / radius) ** 2))
                for c in range(len(PAIRS)):
                    once[c] += weight * products[n, c]
                    twice[c] += weight * weight * products[n, c]
            for c in range(len(PAIRS)):
                a, b = PAIRS[c, 0], PAIRS[c, 1]
                system[a, b] = system[b, a] = once[c]
            for a in range(count):
                terms[a] = RIDGE[a] * (radius / widest) ** (2 * DEGREES[a])
                system[a, a] += terms[a]
            _sweep(system, count)
            misfit = system[count, count]
            for a in range(count):
                misfit -= terms[a] * system[a, count] ** 2
            free, left = once[0], 0.0
            for c in range(len(PAIRS)):
                a, b = PAIRS[c, 0], PAIRS[c, 1]
                if b < count:
                    both = twice[c] if a == b else 2.0 * twice[c]
                    free -= system[a, b] * both
                    left += system[0, a] * system[0, b] * both
            fits[0, j, i] = system[0, count] * widest
            fits[1, j, i] = max(misfit, 0.0) / max(free, 1e-9) * widest**2
            fits[2, j, i] = min(left, 1.0)


@compiled
def _sweep(matrix: Floats, count: int) -> None:
    """Apply the sweep operator to the first `count` rows of a symmetric matrix, in place.

    Normal equations, bordered by their right side, become the inverse, the solution and, in the
    corner, the residual sum of squares (Goodnight 1979).
    """
    for k in range(count):
        pivot = 1.0 / matrix[k, k]
        matrix[k, k] = 1.0
        for b in range(count + 1):
            matrix[k, b] *= pivot
        for a in range(count + 1):
            if a != k:
                factor = matrix[a, k]
                matrix[a, k] = 0.0
                for b in range(count + 1):
                    matrix[a, b] -= factor * matrix[k, b]


@compiled
def measure_cells(
    points: Floats,
    neighbors: Indices,
    distance: Floats,
    variance: float,
    directions: Floats,
    far: float,
    cells: Floats,
) -> None:
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
    cells : ndarray of shape (N, D)
        Output: extents of the cells.
    """
    k, axes = neighbors.shape[1], np.empty((3, 3))
    for i in range(len(points)):
        _tangent_frame(points, neighbors[i], min(CELL_FRAME_NEIGHBORS, k), axes)
        for d in range(len(directions)):
            cells[i, d] = 1.0 / far
        for n in range(k):
            x = y = 0.0
            for a in range(3):
                offset = points[neighbors[i, n], a] - points[i, a]
                x += offset * axes[a, 1]
                y += offset * axes[a, 2]
            length = sqrt(x * x + y * y)
            if length > 0.5 * distance[i, n]:
                # A neighbour at q bounds the cell where |p|² = |p - q|²: in direction w at
                # |q|² / 2 w·q.
                scale = 2.0 / (length * sqrt(max(distance[i, n] ** 2 - variance, length**2)))
                for d in range(len(directions)):
                    bound = scale * (x * directions[d, 0] + y * directions[d, 1])
                    cells[i, d] = max(cells[i, d], bound)
        for d in range(len(directions)):
            cells[i, d] = 1.0 / cells[i, d]
