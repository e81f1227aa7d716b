"""Points that would only disturb: not finite, there twice, far off, more than are wanted.

Every function takes a `Cloud`, gives back a `Cloud` with the points that stay in their order, and
notes what it dropped.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError
from baker.geometry.sampling import voxel_size_for
from baker.scans.cloud import Cloud
from gclip.morton import extent

OUTLIER_NEIGHBORS = 16
MIN_VOXEL_RATIO = 2.0**-60  # edge of the smallest voxels that can be numbered : coordinates

MAX_COORDINATE = 1e12  # beyond are marks of points that weren't measured (1e30, -1e38, ...)
MIN_SCAN_SIZE = 1e-9  # of smaller ones the products of lengths vanish; no unit of plants gives them


def drop_non_finite(cloud: Cloud, path: Path) -> Cloud:
    """Without points that have a coordinate that is NaN, infinite or beyond `MAX_COORDINATE`.

    InputError if none is left, or these have a size, but one below `MIN_SCAN_SIZE`.
    """
    if not len(cloud):
        raise InputError(f"'{path}' holds no points.")
    finite = (np.abs(cloud.points) <= MAX_COORDINATE).all(axis=1)
    if not finite.any():
        raise InputError(
            f"'{path}': none of its {len(cloud)} points has finite coordinates (up to "
            f"{MAX_COORDINATE:g})."
        )
    size = float(np.ptp(extent(cloud.points[finite]), axis=0).max())
    if 0.0 < size < MIN_SCAN_SIZE:
        raise InputError(
            f"'{path}' is only {size:.2g} in size, at least {MIN_SCAN_SIZE:g} is needed; write it "
            "in a smaller unit."
        )
    why = f"with coordinates NaN, infinite or beyond {MAX_COORDINATE:g}"
    return _keep(cloud, np.flatnonzero(finite), why)


def drop_duplicates(cloud: Cloud) -> Cloud:
    """One point for each position, the first of its kind, whatever labels the others have."""
    first, _ = _groups(cloud.points)
    return _keep(cloud, np.sort(first), "at exactly the place of another one")


def drop_outliers(cloud: Cloud, ratio: float) -> Cloud:
    """Without points whose mean distance to their 16 nearest neighbours is more than `ratio`
    standard deviations above the average of the scan: statistical outlier removal by Open3D.
    """
    import open3d

    points = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(cloud.points))
    neighbors = min(OUTLIER_NEIGHBORS + 1, len(cloud))  # each point is its own neighbour there
    _, kept = points.remove_statistical_outlier(neighbors, ratio)
    if not len(kept):  # where all are equally far from their neighbours, none is an outlier
        return cloud
    return _keep(cloud, np.sort(np.asarray(kept, np.intp)), "as outliers")


def downsample(cloud: Cloud, voxel: float) -> Cloud:
    """Voxel down-sampling that keeps labels: `voxel` is the edge, in the unit of the scan."""
    return _keep(cloud, _one_per_voxel(cloud, voxel), f"to keep one for each voxel of {voxel:g}")


def resampled(cloud: Cloud, count: int) -> Cloud:
    """About `count` points, evenly over the surface; a cloud with fewer stays as it is."""
    if len(cloud) <= count:
        return cloud
    kept = _one_per_voxel(cloud, voxel_size_for(cloud.points.astype(np.float64), count))
    note = f"resampled evenly from {len(cloud)} to {len(kept)} points."
    return cloud.take(kept).noting(note)


def _one_per_voxel(cloud: Cloud, voxel: float) -> NDArray[np.intp]:
    """Of the points of one label in one voxel, the one nearest to their mean."""
    points = cloud.points.astype(np.float64)
    cells = np.floor(points / max(voxel, np.abs(points).max(initial=0.0) * MIN_VOXEL_RATIO))
    labels = np.zeros(len(cloud)) if cloud.labels is None else cloud.labels.view(np.float64)
    _, group = _groups(np.column_stack([cells + 0.0, labels]))
    size = np.bincount(group)
    mean = np.stack([np.bincount(group, axis) / size for axis in cloud.points.T], axis=1)
    distance = ((cloud.points - mean[group]) ** 2).sum(axis=1)
    nearest_first = np.lexsort((distance, group))
    _, first = np.unique(group[nearest_first], return_index=True)
    return np.sort(nearest_first[first])


def _groups(rows: NDArray[np.floating]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The first of each group of equal rows (N, k), and the number of each row's group, (N,).

    Equivalent to: ``np.unique(rows, axis=0, return_index=True, return_inverse=True)[1:]`` but for
    the order of the groups, and three times as fast. Zeros must have no sign.
    """
    texts = np.ascontiguousarray(rows).view(f"V{rows.itemsize * rows.shape[1]}").ravel()
    _, first, group = np.unique(texts, return_index=True, return_inverse=True)
    return first, group


def _keep(cloud: Cloud, kept: np.ndarray, why: str) -> Cloud:
    if not (dropped := len(cloud) - len(kept)):
        return cloud
    return cloud.take(kept).noting(f"dropped {dropped} point{'s' * (dropped > 1)} {why}.")
