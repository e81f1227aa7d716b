"""What surface each point of a scan stands for; compiled by numba: import this module late."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.geometry.compiled import compiled

THIN = 1.5  # times less spread than reach from which on points lie on something thin


@compiled
def patches(
    points: NDArray[np.float64], begin: int, near: NDArray[np.integer], reach: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(n,) what surface is around the points of a cloud from `begin` on, up to a factor.

    points: (N, 3) the cloud.
    near:   (n, k) which others of the cloud are around each.
    reach:  (n,) how far the farthest of these is.

    The square of how far they reach; of a twig that is thinner than its points are apart no more
    than their spread along it times that across.
    """
    surface = np.empty(len(near))
    for i in range(len(near)):
        surface[i] = min(reach[i] * reach[i], THIN * _spread(points, begin + i, near[i]))
    return surface


@compiled
def _spread(points: NDArray[np.float64], own: int, near: NDArray[np.integer]) -> float:
    """The square of the radius of the disk that a point and others would be spread evenly on."""
    count = len(near) + 1
    a, b, c = points[own, 0], points[own, 1], points[own, 2]
    for j in near:
        a, b, c = a + points[j, 0], b + points[j, 1], c + points[j, 2]
    a, b, c = a / count, b / count, c / count
    x, y, z = points[own, 0] - a, points[own, 1] - b, points[own, 2] - c
    xx, yy, zz, xy, xz, yz = x * x, y * y, z * z, x * y, x * z, y * z
    for j in near:
        x, y, z = points[j, 0] - a, points[j, 1] - b, points[j, 2] - c
        xx, yy, zz = xx + x * x, yy + y * y, zz + z * z
        xy, xz, yz = xy + x * y, xz + x * z, yz + y * z
    # Of the variances along the principal axes the products of two, summed: of what is no
    # thicker than a sheet that of the larger ones.
    patch = xx * yy - xy**2 + xx * zz - xz**2 + yy * zz - yz**2
    # Evenly spread over a disk the variances are a quarter of its radius squared.
    return 4.0 * np.sqrt(max(patch, 0.0)) / count
