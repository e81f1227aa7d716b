"""Down-sample point clouds by voxels or by farthest points."""

import numpy as np
from numpy.typing import NDArray

ROUNDING = 1e-14  # squared distance of equal points, relative to the largest from the mean
SIZE_TOLERANCE = 1.02  # of the voxel size that `voxel_size_for` finds


def farthest_point_sample(
    points: NDArray[np.float64], count: int, first: int | None = None
) -> NDArray[np.intp]:
    """Choose points one after another, each the farthest from those before (Eldar et al. 1997).

    Parameters
    ----------
    points : (N, 3) float64, N > 0
    count : int
    first : int, optional
        Index of the first point; by default the point farthest from the mean.

    Returns
    -------
    (n,) intp
        Indices of `count` points, or of all distinct points if there are fewer.
    """
    x, y, z = (points - points.mean(axis=0)).T
    norms = x**2 + y**2 + z**2
    # |p - q|² = |p|² - 2 p q + |q|² of all points p in one product, twice as fast as differences.
    terms = np.stack([x, y, z, norms, np.ones_like(x)])
    factors = np.stack([-2.0 * x, -2.0 * y, -2.0 * z, terms[4], norms], axis=1)
    least = ROUNDING * norms.max()
    chosen = [int(np.argmax(norms)) if first is None else first]
    squared, product = np.full(len(points), np.inf), np.empty(len(points))
    while len(chosen) < count:
        np.minimum(squared, np.dot(factors[chosen[-1]], terms, out=product), out=squared)
        farthest = int(squared.argmax())
        if squared[farthest] <= least:
            break
        chosen.append(farthest)
    return np.array(chosen)


def voxel_downsample(points: NDArray[np.float64], size: float) -> NDArray[np.intp]:
    """(M,) ascending indices of the first of (N, 3) points in each voxel.

    size: edge length of a voxel, in the unit of the points; 0 keeps all points.
    """
    if size <= 0.0:
        return np.arange(len(points))
    return np.sort(np.unique(_voxels(points, size), return_index=True)[1])


def voxel_size_for(points: NDArray[np.float64], count: int) -> float:
    """The smallest voxel size for which at most `count` voxels contain points, within 2 %.

    points: (N, 3). The size is in their unit, and 0 if there are no more than `count` points.
    """
    if len(points) <= count:
        return 0.0
    large = float(np.ptp(points, axis=0).max())
    small = 1e-4 * large
    while large > SIZE_TOLERANCE * small:
        middle = float(np.sqrt(small * large))
        if len(np.unique(_voxels(points, middle))) > count:
            small = middle
        else:
            large = middle
    return large


def _voxels(points: NDArray[np.float64], size: float) -> NDArray[np.int64]:
    """(N,) number of the voxel of each point."""
    cell = np.floor((points - points.min(axis=0)) / size).astype(np.int64)
    sides = cell.max(axis=0) + 1
    return np.asarray((cell[:, 0] * sides[1] + cell[:, 1]) * sides[2] + cell[:, 2], np.int64)
