"""Estimation of the radius at which splats close a scanned surface."""

import math
from concurrent.futures import ThreadPoolExecutor
from functools import cache

import numpy as np
from numpy.typing import NDArray

from gclip import Clip
from gclip.evaluate import locate, positions_on_curve

SURFACE_SAMPLES = 1500  # positions on the surface whose distances to points are measured
NEIGHBORS, MAX_NEIGHBORS = 16, 48  # points of a neighbourhood, the latter where 16 are on a line
LINE_WIDTH = 0.1  # of a neighbourhood on a line, as a share of its length
COVERED_SHARE = 0.95  # share of the surface that splats have to cover
MAX_POINTS = 40_000  # points of a scan that are used, which bounds the time of the first picture


class ClosingDistances:
    """Closing distances of a clip over time (see `closing_distance`).

    Measured at the ends of intervals and interpolated, so that splats do not change size at once.
    """

    def __init__(self, clip: Clip) -> None:
        self._clip = clip
        self._at_scan = cache(self._measure)
        self._executor: ThreadPoolExecutor | None = None

    def at(self, day: float) -> float:
        """The distance on a day, in the clip's unit."""
        index, share = locate(self._clip, day)
        return (1.0 - share) * self._at_scan(index) + share * self._at_scan(index + 1)

    def point_area(self, day: float) -> float:
        """The area of the surface divided by the number of movers, in squared units of the clip."""
        count = max(len(self._clip.intervals[locate(self._clip, day)[0]]), 1)
        return float(4.0 * self.at(day) ** 2 * self._scan_points(day) / count)

    def measure_ahead(self) -> None:
        """Start a thread that measures all distances, unless it was started before."""
        if self._executor is None:
            self._executor = ThreadPoolExecutor(1)
            self._executor.map(self._at_scan, range(len(self._clip.intervals) + 1))

    def stop(self) -> None:
        """Stop the thread of `measure_ahead`."""
        if self._executor is not None:
            self._executor.shutdown(cancel_futures=True)

    def _scan_points(self, day: float) -> float:
        """Number of points of a scan, interpolated between the scans."""
        return float(np.interp(day, self._clip.times, [scan.points for scan in self._clip.scans]))

    def _measure(self, scan: int) -> float:
        """The distance at a scan, given by its index; several movers may start at one point."""
        clip, is_last = self._clip, scan == len(self._clip.intervals)
        interval = clip.intervals[scan - 1 if is_last else scan]
        stride = -(-len(interval) // MAX_POINTS)
        parameter, day = (1.0, interval.end) if is_last else (0.0, interval.start)
        points = unique_points(positions_on_curve(interval, slice(None, None, stride), parameter))
        distance = closing_distance(points)
        if stride > 1:
            distance /= math.sqrt(max(self._scan_points(day) / len(points), 1.0))
        return distance or 2.5 * clip.spacing


def unique_points(points: NDArray[np.floating]) -> NDArray[np.floating]:
    """The distinct rows of (N, 3) points on a grid of 2**21 cells per axis, N at least 1."""
    scaled = (points - points.min(axis=0)) / (np.ptp(points) + 1e-30)  # 0 for a single point
    keys = (scaled * (2**21 - 1)).astype(np.uint64) @ np.array([1, 2**21, 2**42], np.uint64)
    return points[np.unique(keys, return_index=True)[1]]


def closing_distance(points: NDArray[np.floating]) -> float:
    """The radius at which splats on (N, 3) points cover most of the sampled surface.

    Distances between neighbours are no measure of it, for scanners' points are dense along lines.
    Instead each neighbourhood, which spans several lines but few leaves, is projected onto its
    tangent plane, and the distance from a random position between three of its points to the
    nearest one is measured.

    Returns the quantile COVERED_SHARE of these distances; 0 for fewer than 4 distinct points.
    """
    from scipy.spatial import cKDTree

    points = unique_points(points).astype(np.float64) if len(points) else points
    count = min(MAX_NEIGHBORS, len(points) - 1)
    if count < 3:
        return 0.0
    random = np.random.default_rng(0)
    centers = points[random.permutation(len(points))[:SURFACE_SAMPLES]]
    tree = cKDTree(points, balanced_tree=False, compact_nodes=False)
    offsets = points[tree.query(centers, k=count + 1)[1]] - centers[:, None]
    near, distances = offsets[:, : NEIGHBORS + 1], []
    spread = np.linalg.eigvalsh(np.einsum("nki,nkj->nij", near, near))
    is_line = spread[:, 1] < LINE_WIDTH**2 * spread[:, 2]
    for part in (near[~is_line], offsets[is_line]):
        _, axes = np.linalg.eigh(np.einsum("nki,nkj->nij", part, part))
        plane = np.einsum("nki,nij->nkj", part, axes[:, :, 1:])  # without the normal
        chosen = random.integers(0, part.shape[1], (len(part), 3))
        corners = np.take_along_axis(plane, chosen[:, :, None], axis=1)
        positions = np.einsum("nc,ncj->nj", random.dirichlet((1, 1, 1), len(part)), corners)
        distances.append(np.linalg.norm(plane - positions[:, None], axis=2).min(axis=1))
    return float(np.quantile(np.concatenate(distances), COVERED_SHARE))
