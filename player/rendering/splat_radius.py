"""Finds the radius at which splats close a scanned surface."""

import math
from concurrent.futures import ThreadPoolExecutor
from functools import cache

import numpy as np
from numpy.typing import NDArray

from gclip import Clip
from gclip.evaluate import positions_on_curve
from gclip.morton import morton_codes

SAMPLES = 1500  # places on the surface that are tested
NEIGHBORS = 48
COVERED = 0.95  # share of the surface that splats have to cover
MOST = 40_000  # points of a scan that are used, so that pictures need not wait


class ClosingDistances:
    """A clip's closing distance: measured at the ends of each interval and linear in between, so
    that splats grow and shrink with the density of points without jumps.
    """

    def __init__(self, clip: Clip) -> None:
        self._clip = clip
        self._end = cache(self._measured)
        self._executor: ThreadPoolExecutor | None = None

    def at(self, index: int, share: float) -> float:
        """The distance in the clip's unit; index, share: as `gclip.evaluate.locate` has them."""
        return (1.0 - share) * self._end(index) + share * self._end(index + 1)

    def measure_ahead(self) -> None:
        """Measure all distances in a thread, so that `at` need not; does so once."""
        if self._executor is None:
            self._executor = ThreadPoolExecutor(1)
            self._executor.map(self._end, range(len(self._clip.intervals) + 1))

    def stop(self) -> None:
        """Stop measuring ahead."""
        if self._executor is not None:
            self._executor.shutdown(cancel_futures=True)

    def _measured(self, end: int) -> float:
        """The distance at the beginning of interval `end`, or at the end of the last one."""
        clip, last = self._clip, end == len(self._clip.intervals)
        interval = clip.intervals[end - 1 if last else end]
        every = -(-len(interval) // MOST)
        points = positions_on_curve(interval, slice(None, None, every), 1.0 if last else 0.0)
        found = closing_distance(points)
        if every > 1:
            # Several movers may start at one point of the scan, so distinct points are counted.
            time = interval.end if last else interval.start
            all_points = np.interp(time, clip.times, [scan.points for scan in clip.scans])
            found /= math.sqrt(max(float(all_points) / distinct_count(points), 1.0))
        return found or 2.5 * clip.spacing


def distinct_count(points: NDArray[np.floating]) -> int:
    """Number of distinct points among (N, 3), at least 1."""
    return max(len(np.unique(morton_codes(points))), 1) if len(points) else 1


def closing_distance(points: NDArray[np.floating]) -> float:
    """The radius at which splats on points cover most of the surface that the points lie on.

    points: (N, 3) on a surface; repeated ones count once.

    Distances between neighbours say little, because a scanner's points lie close together along its
    lines and far apart across them. Instead neighbourhoods are projected to their tangent planes,
    and for random places between three points the distance to the nearest point is found: 19 of 20
    are below the result. Returns 0 for too few points.
    """
    from scipy.spatial import cKDTree

    if len(points) == 0:
        return 0.0
    _, first = np.unique(morton_codes(points), return_index=True)
    distinct = np.asarray(points[first], np.float64)
    count = min(NEIGHBORS, len(distinct) - 1)
    if count < 3:
        return 0.0
    random = np.random.default_rng(0)
    chosen = distinct[random.permutation(len(distinct))[:SAMPLES]]
    tree = cKDTree(distinct, balanced_tree=False, compact_nodes=False)
    offsets = distinct[tree.query(chosen, k=count + 1)[1]] - chosen[:, None]
    _, axes = np.linalg.eigh(np.einsum("nki,nkj->nij", offsets, offsets))
    flat = np.einsum("nki,nij->nkj", offsets, axes[:, :, 1:])
    corners = flat[np.arange(len(flat))[:, None], random.integers(0, count + 1, (len(flat), 3))]
    places = np.einsum("nc,ncj->nj", random.dirichlet((1, 1, 1), len(flat)), corners)
    found = np.linalg.norm(flat - places[:, None], axis=2).min(axis=1)
    return float(np.quantile(found, COVERED))
