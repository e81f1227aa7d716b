"""The origin of a scan's coordinates, and the removal of points.

Points are removed that are not finite, duplicates or outliers, or to down-sample the scan. The
points that are left keep their order, and a note on the scan says how many were removed.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError
from baker.geometry.sampling import voxel_size_for
from baker.scans.scan import Scan
from gclip.schema import extent

MAX_SAMPLE = 20_000  # points of a scan from which its bounding box is estimated
MAX_DISTANCE_RATIO = 16  # distance from zero to size of a series, above which its origin moves
MAX_STEP_RATIO = 1e-5  # float32 step to size of a scan, above which it gets its own origin
MIN_COORDINATE = 1e-18  # smaller ones become 0: their squares are 0 in float32
MAX_COORDINATE = 1e12  # larger ones mark points that weren't measured (1e30, -1e38, ...)
MIN_SCAN_SIZE = 1e-9  # products of lengths in a smaller scan underflow in float32
OUTLIER_NEIGHBORS = 16  # number of neighbours whose mean distance is compared
MIN_VOXEL_RATIO = 2.0**-60  # edge of a voxel to largest coordinate; smaller voxels have no numbers


def shared_origin(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Choose the (3,) origin of a series from the (N, 3) world positions of its first scan.

    It is zero if float32 coordinates are precise enough there (steps below 2e-6 of the plant's
    size). Otherwise it is the lower corner of the box from the 1st to the 99th percentile, rounded
    down to the power of ten below the size of the box. The percentiles leave out points at zero,
    which some scanners add.
    """
    low, high = np.percentile(points, [1, 99], axis=0)
    size = float((high - low).max())
    if size == 0 or max(np.abs(low).max(), np.abs(high).max()) <= MAX_DISTANCE_RATIO * size:
        return np.zeros(3)
    digits = -int(np.floor(np.log10(size)))
    step = 10.0**-digits
    return np.round(np.floor(low / step) * step, max(digits, 0))


def relative_to(shared: NDArray[np.float64], scan: Scan) -> Scan:
    """Convert the points of a scan to float32 relative to the (3,) origin of the series.

    The scan gets an origin of its own if it is so far from that of the series, in another
    coordinate system, that float32 coordinates would not resolve its points.
    """
    sample = scan.points[:: -(-len(scan) // MAX_SAMPLE)] - shared
    low, high = np.percentile(sample, [1, 99], axis=0)
    step = 2.0**-23 * max(np.abs(low).max(), np.abs(high).max())
    is_far = step > MAX_STEP_RATIO * (high - low).max() > 0
    origin = shared_origin(scan.points) if is_far else shared
    # Adding zero turns -0.0 into 0.0, so that equal points have equal bytes.
    exact = scan.points - origin + 0.0
    local = np.where(np.abs(exact) < MIN_COORDINATE, 0.0, exact).astype(np.float32)
    return replace(scan, points=local, origin=origin)


def drop_non_finite(scan: Scan) -> Scan:
    """Remove points with a coordinate that is NaN, infinite or beyond `MAX_COORDINATE`.

    Raises InputError if no point is left, or if the scan is smaller than `MIN_SCAN_SIZE` (a scan
    whose points are all in one place is allowed).
    """
    if not len(scan):
        raise InputError(f"'{scan.path}' holds no points.")
    finite = (np.abs(scan.points) <= MAX_COORDINATE).all(axis=1)
    if not finite.any():
        raise InputError(
            f"'{scan.path}': none of its {len(scan)} points has finite coordinates (up to "
            f"{MAX_COORDINATE:g})."
        )
    size = float(np.ptp(extent(scan.points[finite]), axis=0).max())
    if 0.0 < size < MIN_SCAN_SIZE:
        raise InputError(
            f"'{scan.path}' is only {size:.2g} in size, at least {MIN_SCAN_SIZE:g} is needed; "
            "write it in a smaller unit."
        )
    why = f"with coordinates NaN, infinite or beyond {MAX_COORDINATE:g}"
    return _keep(scan, np.flatnonzero(finite), why)


def drop_duplicates(scan: Scan) -> Scan:
    """Keep the first of the points that have the same position, whatever their labels."""
    # Most scans have none: a sum that is equal for duplicates differs among all points.
    x, y, z = scan.points.T.astype(np.float64)
    if np.diff(np.sort(x + np.e * y + np.pi * z)).all():
        return scan
    _, first = np.unique(_row_bytes(scan.points), return_index=True)
    return _keep(scan, np.sort(first), "at exactly the place of another one")


def drop_outliers(scan: Scan, ratio: float) -> Scan:
    """Remove statistical outliers as Open3D defines them.

    They are the points whose mean distance to their 16 nearest neighbours is more than `ratio`
    standard deviations above its mean.
    """
    import open3d

    points = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(scan.points))
    neighbors = min(OUTLIER_NEIGHBORS + 1, len(scan))  # Open3D counts the point itself
    _, inliers = points.remove_statistical_outlier(neighbors, ratio)
    if not len(inliers):  # Open3D removes all points if their mean distances are all equal
        return scan
    return _keep(scan, np.sort(np.asarray(inliers, np.intp)), "as outliers")


def downsample(scan: Scan, voxel: float) -> Scan:
    """Keep one point of each label in each voxel with edges of length `voxel` (unit of the scan).

    It is the point nearest to the mean of the points with that label in that voxel.
    """
    points = scan.points.astype(np.float64)
    cells = np.floor(points / max(voxel, np.abs(points).max(initial=0.0) * MIN_VOXEL_RATIO))
    # The bytes of labels are compared with those of the cells.
    labels = np.zeros(len(scan)) if scan.labels is None else scan.labels.view(np.float64)
    rows = _row_bytes(np.column_stack([cells + 0.0, labels]))
    _, group = np.unique(rows, return_inverse=True)
    size = np.bincount(group)
    mean = np.stack([np.bincount(group, axis) / size for axis in scan.points.T], axis=1)
    distance = ((scan.points - mean[group]) ** 2).sum(axis=1)
    nearest = np.lexsort((distance, group))[np.cumsum(size) - size]
    return _keep(scan, np.sort(nearest), f"to keep one for each voxel of {voxel:.6g}")


def downsample_to(scan: Scan, count: int) -> Scan:
    """Down-sample a scan by voxels to about `count` points; a smaller scan stays as it is."""
    voxel = voxel_size_for(scan.points.astype(np.float64), count)
    return downsample(scan, voxel) if voxel else scan


def _row_bytes(rows: NDArray[np.floating]) -> NDArray[np.void]:
    """(N,) the bytes of each of (N, k) rows, which must not contain -0.0.

    `np.unique` sorts them three times as fast as it does the rows with ``axis=0``.
    """
    return np.ascontiguousarray(rows).view(f"V{rows.itemsize * rows.shape[1]}").ravel()


def _keep(scan: Scan, remaining: NDArray[np.intp], why: str) -> Scan:
    """Keep the points with these indices, and note how many others were dropped, and why."""
    if not (dropped := len(scan) - len(remaining)):
        return scan
    return scan.take(remaining).noting(f"dropped {dropped} point{'s' * (dropped > 1)} {why}.")
