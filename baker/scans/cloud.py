"""One scan on its way from the file to a `Scan`: its place, and the points that only disturb.

Those are not finite, there twice, far off, or more than are wanted: what drops points leaves the
others in their order, and notes how many went.
"""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError
from baker.geometry.sampling import voxel_size_for
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


@dataclass(frozen=True)
class Columns:
    """All fields of one file, as they stand in it.

    values:  field name as written in the file -> (N,) numbers of any dtype, all the same length;
             or words, where it may be that of labels.
    notes:   what the reader had to decide, one sentence each.
    """

    values: dict[str, NDArray]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Cloud:
    """One scan on its way from the file to a `Scan`.

    points:  (N, 3), float64 world positions at first, float32 about the series' origin later.
    labels:  (N,) int64 or None.
    colors:  (N, 3) uint8 sRGB or None.
    notes:   one sentence for each thing found or dropped on the way.
    fields:  name -> (N,) numbers or words, that may be labels; which ones the series decides.
    scalars: name -> (N,) float32, what else is carried into the clip.
    """

    points: NDArray
    labels: NDArray[np.int64] | None = None
    colors: NDArray[np.uint8] | None = None
    notes: tuple[str, ...] = ()
    fields: dict[str, NDArray] = field(default_factory=dict)
    scalars: dict[str, NDArray[np.float32]] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.points)

    def take(self, chosen: NDArray) -> "Cloud":
        """The points at the indices (or where the mask) `chosen`, with their labels and colours."""
        labels = None if self.labels is None else self.labels[chosen]
        colors = None if self.colors is None else self.colors[chosen]
        fields = {name: values[chosen] for name, values in self.fields.items()}
        scalars = {name: values[chosen] for name, values in self.scalars.items()}
        return Cloud(self.points[chosen], labels, colors, self.notes, fields, scalars)

    def noting(self, sentence: str) -> Self:
        return replace(self, notes=(*self.notes, sentence))


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


def relative_to(origin: NDArray[np.float64], cloud: Cloud) -> Cloud:
    """`cloud` with points in float32 about `origin`."""
    # Adding zero turns -0.0 into 0.0, so that equal points have equal bytes.
    exact = cloud.points - origin + 0.0
    local = np.where(np.abs(exact) < MIN_COORDINATE, 0.0, exact).astype(np.float32)
    return replace(cloud, points=local)


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
    # Few points share a place, if any: only those that share a hash are compared.
    hashes = np.ascontiguousarray(cloud.points).view(np.uint32).astype(np.uint64) @ HASH_FACTORS
    ordered = np.sort(hashes)
    alike = np.flatnonzero(np.isin(hashes, ordered[1:][ordered[1:] == ordered[:-1]]))
    repeated = np.delete(alike, _groups(cloud.points[alike])[0])
    kept = np.delete(np.arange(len(cloud)), repeated)
    return _keep(cloud, kept, "at exactly the place of another one")


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
