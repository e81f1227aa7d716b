"""The place of a scan, and its points that only disturb.

Those are not finite, there twice, far off, or more than are wanted: what drops points leaves the
others in their order, and notes how many went.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError
from baker.geometry.sampling import voxel_size_for
from baker.scans.scan import Scan
from gclip.morton import extent

MAX_DISTANCE_RATIO = 16  # scans further from zero than so many of their sizes get an own origin
MIN_COORDINATE = 1e-18  # nearer to the origin is zero: in 32 bits its square is nothing
MAX_SAMPLES = 20_000  # points of a scan by which its place is found
MAX_STEP_RATIO = 1e-5  # of a scan's size: with larger float32 steps it gets its own origin
OUTLIER_NEIGHBORS = 16
MIN_VOXEL_RATIO = 2.0**-60  # edge of the smallest voxels that can be numbered : coordinates
MAX_COORDINATE = 1e12  # beyond are marks of points that weren't measured (1e30, -1e38, ...)
HASH_FACTORS = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], np.uint64)
MIN_SCAN_SIZE = 1e-9  # of smaller ones the products of lengths vanish; no unit of plants gives them


def shared_origin(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """The (3,) origin of a series, by the (N, 3) world positions of its first scan.

    Zeros while float32 about the world's zero is exact enough (its step stays below 2e-6 of the
    plant); beyond that the lower corner of the box of 98 % of the points along each axis, as a
    scanner's zero returns don't count, rounded down to the power of ten below the box's size.
    """
    low, high = np.percentile(points, [1, 99], axis=0)
    size = float((high - low).max())
    if size == 0 or max(np.abs(low).max(), np.abs(high).max()) <= MAX_DISTANCE_RATIO * size:
        return np.zeros(3)
    digits = -int(np.floor(np.log10(size)))
    step = 10.0**-digits
    return np.round(np.floor(low / step) * step, max(digits, 0))


def own_origin(points: NDArray[np.float64], shared: NDArray[np.float64]) -> NDArray[np.float64]:
    """The (3,) origin of one scan: the series', unless its (N, 3) world positions are far from it.

    Then they are in another coordinate system, and float32 about its origin would lose them.
    """
    some = points[:: -(-len(points) // MAX_SAMPLES)] - shared
    low, high = np.percentile(some, [1, 99], axis=0)
    step = 2.0**-23 * max(np.abs(low).max(), np.abs(high).max())
    return shared_origin(points) if step > MAX_STEP_RATIO * (high - low).max() > 0 else shared


def relative_to(shared: NDArray[np.float64], scan: Scan) -> Scan:
    """`scan` with points in float32 about the series' origin, or its own where that is far off."""
    origin = own_origin(scan.points, shared)
    # Adding zero turns -0.0 into 0.0, so that equal points have equal bytes.
    exact = scan.points - origin + 0.0
    local = np.where(np.abs(exact) < MIN_COORDINATE, 0.0, exact).astype(np.float32)
    return replace(scan, points=local, origin=origin)


def drop_non_finite(scan: Scan) -> Scan:
    """Without points that have a coordinate that is NaN, infinite or beyond `MAX_COORDINATE`.

    InputError if none is left, or these have a size, but one below `MIN_SCAN_SIZE`.
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
    """One point for each position, the first of its kind, whatever labels the others have."""
    # Few points share a place, if any: only those that share a hash are compared.
    words = np.ascontiguousarray(scan.points).view(np.uint32)
    hashes = (words.astype(np.uint64) @ HASH_FACTORS).view(np.int64)  # isin of NumPy 2.0 needs it
    ordered = np.sort(hashes)
    alike = np.flatnonzero(np.isin(hashes, ordered[1:][ordered[1:] == ordered[:-1]]))
    repeated = np.delete(alike, _groups(scan.points[alike])[0])
    kept = np.delete(np.arange(len(scan)), repeated)
    return _keep(scan, kept, "at exactly the place of another one")


def drop_outliers(scan: Scan, ratio: float) -> Scan:
    """Without points whose mean distance to their 16 nearest neighbours is more than `ratio`
    standard deviations above the average of the scan: statistical outlier removal by Open3D.
    """
    import open3d

    points = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(scan.points))
    neighbors = min(OUTLIER_NEIGHBORS + 1, len(scan))  # each point is its own neighbour there
    _, kept = points.remove_statistical_outlier(neighbors, ratio)
    if not len(kept):  # where all are equally far from their neighbours, none is an outlier
        return scan
    return _keep(scan, np.sort(np.asarray(kept, np.intp)), "as outliers")


def downsample(scan: Scan, voxel: float) -> Scan:
    """Voxel down-sampling that keeps labels: `voxel` is the edge, in the unit of the scan."""
    return _keep(scan, _one_per_voxel(scan, voxel), f"to keep one for each voxel of {voxel:g}")


def resampled(scan: Scan, count: int) -> Scan:
    """About `count` points, evenly over the surface; a scan with fewer stays as it is."""
    if len(scan) <= count:
        return scan
    kept = _one_per_voxel(scan, voxel_size_for(scan.points.astype(np.float64), count))
    note = f"resampled evenly from {len(scan)} to {len(kept)} points."
    return scan.take(kept).noting(note)


def _one_per_voxel(scan: Scan, voxel: float) -> NDArray[np.intp]:
    """Of the points of one label in one voxel, the one nearest to their mean."""
    points = scan.points.astype(np.float64)
    cells = np.floor(points / max(voxel, np.abs(points).max(initial=0.0) * MIN_VOXEL_RATIO))
    labels = np.zeros(len(scan)) if scan.labels is None else scan.labels.view(np.float64)
    _, group = _groups(np.column_stack([cells + 0.0, labels]))
    size = np.bincount(group)
    mean = np.stack([np.bincount(group, axis) / size for axis in scan.points.T], axis=1)
    distance = ((scan.points - mean[group]) ** 2).sum(axis=1)
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


def _keep(scan: Scan, kept: np.ndarray, why: str) -> Scan:
    if not (dropped := len(scan) - len(kept)):
        return scan
    return scan.take(kept).noting(f"dropped {dropped} point{'s' * (dropped > 1)} {why}.")
