"""What surface each point of a scan stands for."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

BATCH = 8192  # points, whose neighbours stay in the processor's cache
THIN = 1.5  # times less spread than reach from which on points lie on something thin


def patches(
    points: NDArray[np.floating], near: NDArray[np.integer], reach: NDArray[np.floating]
) -> NDArray[np.float64]:
    """(N,) what surface is around each of (N, 3) points, up to a factor.

    near:  (N, k) which points of the cloud are around it, itself among them.
    reach: (N,) how far the farthest of these is.

    The square of how far they reach; of a twig that is thinner than its points are apart no more
    than their spread along it times that across.
    """
    patch = np.empty(len(near))
    for first in range(0, len(near), BATCH):
        around = points[near[first : first + BATCH]].astype(np.float64)
        x, y, z = np.moveaxis(around - around.mean(axis=1, keepdims=True), 2, 0)
        xx, yy, zz = (np.einsum("nk,nk->n", axis, axis) for axis in (x, y, z))
        xy, xz, yz = (np.einsum("nk,nk->n", *pair) for pair in ((x, y), (x, z), (y, z)))
        # Of the variances along the principal axes the products of two, summed: of what is no
        # thicker than a sheet that of the larger ones.
        patch[first : first + BATCH] = xx * yy - xy**2 + xx * zz - xz**2 + yy * zz - yz**2
    # Evenly spread over a disk the variances are a quarter of its radius squared.
    spread = 4.0 * np.sqrt(np.maximum(patch, 0.0)) / near.shape[1]
    surface: NDArray[np.float64] = np.minimum(reach**2, THIN * spread)
    return surface
