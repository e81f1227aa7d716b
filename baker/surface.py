"""What surface each point of a scan stands for."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

THIN = 1.5  # times less spread than reach from which on points lie on something thin


def patches(
    axes: NDArray[np.float64], near: NDArray[np.integer], reach: NDArray[np.floating]
) -> NDArray[np.float64]:
    """(n,) what surface is around points of a cloud, up to a factor.

    axes:  (3, N) the cloud's coordinates.
    near:  (n, k) which points of the cloud are around each, itself among them.
    reach: (n,) how far the farthest of these is.

    The square of how far they reach; of a twig that is thinner than its points are apart no more
    than their spread along it times that across.
    """
    surface: NDArray[np.float64] = np.minimum(reach**2, THIN * _spread(axes, near.T))
    return surface


def _spread(axes: NDArray[np.float64], near: NDArray[np.integer]) -> NDArray[np.float64]:
    """(n,) the square of the radius of the disk that points would be evenly spread on.

    near: (k, n), so that whole rows are added up.
    """
    near = np.ascontiguousarray(near)
    x, y, z = (axis.take(near) for axis in axes)
    for around in (x, y, z):
        around -= around.mean(axis=0)
    xx, yy, zz = (np.einsum("kn,kn->n", axis, axis) for axis in (x, y, z))
    xy, xz, yz = (np.einsum("kn,kn->n", *pair) for pair in ((x, y), (x, z), (y, z)))
    # Of the variances along the principal axes the products of two, summed: of what is no
    # thicker than a sheet that of the larger ones.
    patch = xx * yy - xy**2 + xx * zz - xz**2 + yy * zz - yz**2
    # Evenly spread over a disk the variances are a quarter of its radius squared.
    spread: NDArray[np.float64] = 4.0 * np.sqrt(np.maximum(patch, 0.0)) / len(near)
    return spread
