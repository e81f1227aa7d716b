"""What surface each point of a scan stands for."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.workers import Crew

BATCH = 8192  # points, whose neighbours stay in the processor's cache
THIN = 1.5  # times less spread than reach from which on points lie on something thin


def patches(
    points: NDArray[np.floating],
    near: NDArray[np.integer],
    reach: NDArray[np.floating],
    workers: int = 1,
) -> NDArray[np.float64]:
    """(N,) what surface is around each of (N, 3) points, up to a factor.

    near:  (N, k) which points of the cloud are around it, itself among them.
    reach: (N,) how far the farthest of these is.
    workers: threads.

    The square of how far they reach; of a twig that is thinner than its points are apart no more
    than their spread along it times that across.
    """
    batches = [slice(first, first + BATCH) for first in range(0, len(near), BATCH)]
    spread = Crew(workers).map(lambda batch: _spread(points[near[batch]]), batches)
    surface: NDArray[np.float64] = np.minimum(reach**2, THIN * np.concatenate(spread))
    return surface


def _spread(around: NDArray[np.floating]) -> NDArray[np.float64]:
    """(n,) the square of the radius of the disk that (n, k, 3) points would be evenly spread on."""
    around = around.astype(np.float64)
    x, y, z = np.moveaxis(around - around.mean(axis=1, keepdims=True), 2, 0)
    xx, yy, zz = (np.einsum("nk,nk->n", axis, axis) for axis in (x, y, z))
    xy, xz, yz = (np.einsum("nk,nk->n", *pair) for pair in ((x, y), (x, z), (y, z)))
    # Of the variances along the principal axes the products of two, summed: of what is no
    # thicker than a sheet that of the larger ones.
    patch = xx * yy - xy**2 + xx * zz - xz**2 + yy * zz - yz**2
    # Evenly spread over a disk the variances are a quarter of its radius squared.
    spread: NDArray[np.float64] = 4.0 * np.sqrt(np.maximum(patch, 0.0)) / around.shape[1]
    return spread
