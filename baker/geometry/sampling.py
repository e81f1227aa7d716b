"""Down-sample point clouds by voxels or by farthest points."""

import numpy as np
from numpy.typing import NDArray

SIZE_TOLERANCE = 1.02  # of the voxel size that `voxel_size_for` finds


def farthest_point_sample(
    points: NDArray[np.float64], count: int, first: int | None = None
) -> NDArray[np.intp]:
    """Choose points one after another, each the farthest from those chosen before.

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

    References
    ----------
    Eldar et al.: The farthest point strategy for progressive image sampling (1997).
    """
    if first is None:
        first = int(np.argmax(((points - points.mean(axis=0)) ** 2).sum(axis=1)))
    chosen, axes = [first], np.ascontiguousarray(points.T)
    squared = np.full(len(points), np.inf)  # distance to the nearest of the chosen points
    while len(chosen) < count:
        x, y, z = axes - axes[:, chosen[-1], None]
        squared = np.minimum(squared, x * x + y * y + z * z)
        farthest = int(squared.argmax())
        if squared[farthest] == 0.0:
            break
        chosen.append(farthest)
    return np.array(chosen)


def voxel_downsample(points: NDArray[np.float64], size: float) -> NDArray[np.intp]:
    """Indices of the first point in each voxel.

    Parameters
    ----------
    points : (N, 3) float64
    size : float
        Edge length of a voxel, in the unit of the points; 0 keeps all points.

    Returns
    -------
    (M,) intp
        In ascending order.
    """
    if size <= 0.0:
        return np.arange(len(points))
    return np.sort(np.unique(_voxels(points, size), return_index=True)[1])


def voxel_size_for(points: NDArray[np.float64], count: int) -> float:
    """The smallest voxel size for which at most `count` voxels contain points.

    Parameters
    ----------
    points : (N, 3) float64
    count : int

    Returns
    -------
    float
        Edge length of a voxel in the unit of the points, within 2 %.
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
    cell = np.floor((points - points.min(axis=0)) / size).astype(np.int64)
    sides = cell.max(axis=0) + 1
    return np.asarray((cell[:, 0] * sides[1] + cell[:, 1]) * sides[2] + cell[:, 2], np.int64)
