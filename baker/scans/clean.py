"""Points that would only disturb: not finite, there twice, far off, or more than are wanted.

Every function takes a `Cloud`, gives back a `Cloud` with the points that stay in their order, and
notes what it dropped.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from baker.errors import InputError
from baker.scans.cloud import Cloud
from gclip.morton import extent

OUTLIER_NEIGHBORS = 16
FINEST = 2.0**-60  # edge of the smallest cubes that can be numbered, in the coordinates' size
RESAMPLING_STEPS = 30

FARTHEST = 1e12
"""Coordinates beyond are marks of points that weren't measured (1e30, -1e38, ...); they would be
too large for 32-bit numbers to hold their products."""

SMALLEST = 1e-9
"""Scans of a smaller size are in no unit that plants are measured in, and so small that products
of their lengths vanish."""


def drop_non_finite(cloud: Cloud, path: Path) -> Cloud:
    """Without points that have a coordinate that is NaN, infinite or beyond `FARTHEST`.

    InputError if none is left.
    """
    if not len(cloud):
        raise InputError(f"'{path}' holds no points.")
    with np.errstate(invalid="ignore"):
        low, high = extent(cloud.points)  # NaN where any is
        if (low >= -FARTHEST).all() and (high <= FARTHEST).all():
            return cloud
        finite = (np.abs(cloud.points) <= FARTHEST).all(axis=1)
    if not finite.any():
        raise InputError(
            f"'{path}': none of its {len(cloud)} points has finite coordinates (up to "
            f"{FARTHEST:g})."
        )
    why = f"with coordinates NaN, infinite or beyond {FARTHEST:g}"
    return _keep(cloud, np.flatnonzero(finite), why)


def require_size(cloud: Cloud, path: Path) -> None:
    """InputError for a scan that has a size, but one below `SMALLEST`."""
    low, high = extent(cloud.points)
    size = float((high - low).max())
    if 0.0 < size < SMALLEST:
        raise InputError(
            f"'{path}' is only {size:.2g} in size, at least {SMALLEST:g} is needed; write it in "
            "a smaller unit."
        )


def drop_duplicates(cloud: Cloud) -> Cloud:
    """One point for each position, the first of its kind, whatever labels the others have."""
    if _all_differ(cloud.points):
        return cloud
    order = np.lexsort(cloud.points.T)
    ordered = cloud.points[order]
    is_new = np.ones(len(order), bool)
    is_new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    # lexsort is stable: the first of equal positions is the one that came first in the file.
    return _keep(cloud, np.sort(order[is_new]), "at exactly the place of another one")


def _all_differ(points: np.ndarray) -> bool:
    """Whether no two of (N, 3) points are equal, for certain: by one number mixed from each."""
    if points.dtype != np.float32:
        return False
    bits = np.ascontiguousarray(points).view(np.uint32).astype(np.uint64)
    mixed = bits[:, 0]
    for axis in (1, 2):
        mixed = (mixed ^ (mixed >> np.uint64(29))) * np.uint64(0x9E3779B97F4A7C15) + bits[:, axis]
    mixed.sort()
    return bool((mixed[1:] != mixed[:-1]).all())


def drop_outliers(cloud: Cloud, ratio: float, path: Path) -> Cloud:
    """Statistical outlier removal: see `baker.scans.ReadOptions.outliers`.

    Source: R. B. Rusu et al., Towards 3D Point Cloud Based Object Maps for Household
    Environments, Robotics and Autonomous Systems 56, 2008.
    """
    from scipy.spatial import KDTree

    k = min(OUTLIER_NEIGHBORS, len(cloud) - 1)
    if k < 1:
        return cloud
    distances, _ = KDTree(cloud.points).query(cloud.points, k + 1)
    mean = distances[:, 1:].mean(axis=1)
    keep = np.flatnonzero(mean <= mean.mean() + ratio * mean.std())
    if not len(keep):
        raise InputError(f"'{path}': outlier removal with {ratio:g} leaves no point.")
    return _keep(cloud, keep, "as outliers")


def thin(cloud: Cloud, voxel: float) -> Cloud:
    """Of each cube of edge `voxel`, and of each label in it, the point nearest to their mean."""
    points = cloud.points.astype(np.float64)
    cells = np.floor(points / max(voxel, np.abs(points).max(initial=0.0) * FINEST))
    keys = list(cells.T) if cloud.labels is None else [*cells.T, cloud.labels]
    order = np.lexsort(keys)
    is_new = np.ones(len(order), bool)
    is_new[1:] = np.any([key[order][1:] != key[order][:-1] for key in keys], axis=0)
    group = np.empty(len(order), np.int64)
    group[order] = np.cumsum(is_new) - 1

    size = np.bincount(group)
    mean = np.stack([np.bincount(group, axis) / size for axis in cloud.points.T], axis=1)
    distance = ((cloud.points - mean[group]) ** 2).sum(axis=1)
    nearest_first = np.lexsort((distance, group))
    nearest = nearest_first[np.searchsorted(group[nearest_first], np.arange(len(size)))]
    return _keep(cloud, np.sort(nearest), f"to keep one for each voxel of {voxel:g}")


def resampled(cloud: Cloud, count: int) -> Cloud:
    """About `count` points, evenly over the surface: the cubes of `thin` grow until that few stay.

    A cloud with fewer stays as it is; within 2 % where points are not stacked label upon label.
    """
    if len(cloud) <= count:
        return cloud
    low, high = 0.0, float(np.ptp(cloud.points, axis=0).max())
    best = cloud
    for _ in range(RESAMPLING_STEPS):
        middle = (low + high) / 2
        kept = thin(replace(cloud, notes=()), middle)
        if abs(len(kept) - count) < abs(len(best) - count):
            best = kept
        if abs(len(kept) - count) <= 0.02 * count:
            break
        low, high = (middle, high) if len(kept) > count else (low, middle)
    return replace(best, notes=cloud.notes).noting(
        f"resampled evenly from {len(cloud)} to {len(best)} points."
    )


def _keep(cloud: Cloud, kept: np.ndarray, why: str) -> Cloud:
    dropped = len(cloud) - len(kept)
    if not dropped:
        return cloud
    points = "point" if dropped == 1 else "points"
    return cloud.take(kept).noting(f"dropped {dropped} {points} {why}.")
