"""Finds the radius at which splats close a scanned surface."""

import math
from concurrent.futures import ThreadPoolExecutor
from functools import cache

import numpy as np
from numpy.typing import NDArray

from gclip import Clip
from gclip.evaluate import locate, positions_on_curve

SAMPLES = 1500  # places on the surface that are tested
NEIGHBORS = 48
COVERED = 0.95  # share of the surface that splats have to cover
TINY = 1e-30  # so that a single point is divided by something
MOST = 40_000  # points of a scan that are used, so that pictures need not wait


class ClosingDistances:
    """A clip's closing distance: measured at the ends of each interval and linear in between, so
    that splats grow and shrink with the density of points without jumps.
    """

    def __init__(self, clip: Clip) -> None:
        self._clip = clip
        self._end = cache(self._measured)
        self._executor: ThreadPoolExecutor | None = None

    def at(self, day: float) -> float:
        """The distance on a day, in the clip's unit."""
        index, share = locate(self._clip, day)
        return (1.0 - share) * self._end(index) + share * self._end(index + 1)

    def point_area(self, day: float) -> float:
        """Area that one mover covers: the surface of a scan, divided among the movers."""
        index, _ = locate(self._clip, day)
        count = max(len(self._clip.intervals[index]), 1)
        return float(4.0 * self.at(day) ** 2 * self._scanned(day) / count)

    def measure_ahead(self) -> None:
        """Measure all distances in a thread, so that `at` need not; does so once."""
        if self._executor is None:
            self._executor = ThreadPoolExecutor(1)
            self._executor.map(self._end, range(len(self._clip.intervals) + 1))

    def stop(self) -> None:
        """Stop measuring ahead."""
        if self._executor is not None:
            self._executor.shutdown(cancel_futures=True)

    def _scanned(self, day: float) -> float:
        """Number of points that a scan on this day would have."""
        return float(np.interp(day, self._clip.times, [scan.points for scan in self._clip.scans]))

    def _measured(self, end: int) -> float:
        """The distance at the beginning of interval `end`, or at the end of the last one."""
        clip, last = self._clip, end == len(self._clip.intervals)
        interval = clip.intervals[end - 1 if last else end]
        every = -(-len(interval) // MOST)
        # Several movers may start at one point of the scan.
        parameter, day = (1.0, interval.end) if last else (0.0, interval.start)
        points = distinct(positions_on_curve(interval, slice(None, None, every), parameter))
        found = closing_distance(points)
        if every > 1:
            found /= math.sqrt(max(self._scanned(day) / len(points), 1.0))
        return found or 2.5 * clip.spacing


def distinct(points: NDArray[np.floating]) -> NDArray[np.floating]:
    """Those of (N, 3) points that differ, N at least 1."""
    places = (points - points.min(axis=0)) / (np.ptp(points) + TINY)  # in [0, 1]
    keys = (places * (2**21 - 1)).astype(np.uint64) @ np.array([1, 2**21, 2**42], np.uint64)
    return points[np.unique(keys, return_index=True)[1]]


def closing_distance(points: NDArray[np.floating]) -> float:
    """The radius at which splats on points cover most of the surface that the points lie on.

    points: (N, 3) on a surface; repeated ones count once.

    Distances between neighbours say little, because a scanner's points lie close together along its
    lines and far apart across them. Instead neighbourhoods are projected to their tangent planes,
    and for random places between three points the distance to the nearest point is found: 19 of 20
    are below the result. Returns 0 for too few points.
    """
    from scipy.spatial import cKDTree

    points = distinct(points).astype(np.float64) if len(points) else points
    count = min(NEIGHBORS, len(points) - 1)
    if count < 3:
        return 0.0
    random = np.random.default_rng(0)
    chosen = points[random.permutation(len(points))[:SAMPLES]]
    tree = cKDTree(points, balanced_tree=False, compact_nodes=False)
    offsets = points[tree.query(chosen, k=count + 1)[1]] - chosen[:, None]
    _, axes = np.linalg.eigh(np.einsum("nki,nkj->nij", offsets, offsets))
    flat = np.einsum("nki,nij->nkj", offsets, axes[:, :, 1:])
    corners = flat[np.arange(len(flat))[:, None], random.integers(0, count + 1, (len(flat), 3))]
    places = np.einsum("nc,ncj->nj", random.dirichlet((1, 1, 1), len(flat)), corners)
    found = np.linalg.norm(flat - places[:, None], axis=2).min(axis=1)
    return float(np.quantile(found, COVERED))
