"""Finds the radius at which splats close a scanned surface."""

import math
import threading
from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from gclip import Clip
from gclip.errors import ClipError
from gclip.evaluate import positions_on_curve
from gclip.morton import morton_codes

SAMPLES = 1500  # places on the surface that are tested
ROUGH = 150  # places for a first estimate
NEIGHBORS = 48
COVERED = 0.95  # share of the surface that splats have to cover
MOST = 40_000  # points of a scan that are used, so that pictures need not wait


class ClosingDistances:
    """A clip's closing distance: measured at the ends of each interval and linear in between, so
    that splats grow and shrink with the density of points without jumps.
    """

    def __init__(self, clip: Clip) -> None:
        self._clip = clip
        self._at_end: dict[int, float] = {}
        self._thread: threading.Thread | None = None
        self._stopped = False
        self._guess: float | None = None

    def at(self, index: int, share: float, wait: bool = True) -> float:
        """The distance in the clip's unit; index, share: as `gclip.evaluate.locate` returns them.

        wait: measure what is not measured yet; otherwise the distance at the nearest time is used,
              or an estimate.
        """
        first, second = self._end(index, wait), self._end(index + 1, wait)
        return (1.0 - share) * first + share * second

    def release(self) -> None:
        self._stopped = True
        if self._thread is not None:
            self._thread.join()

    def settled(self, index: int) -> bool:
        """Whether an interval's distances are measured rather than estimated."""
        return index in self._at_end and index + 1 in self._at_end

    def measure(self, first: int) -> None:
        """Measure all distances in a thread, those nearest to interval `first` first."""
        if self._thread is None:
            self._thread = threading.Thread(target=self._measure_all, args=(first,), daemon=True)
            self._thread.start()

    def _end(self, end: int, wait: bool) -> float:
        if wait or end in self._at_end:
            return self._measured(end)
        known = self._at_end.copy()
        if known:
            return known[min(known, key=lambda other: abs(other - end))]
        if self._guess is None:
            self._guess = self._found(end, roughly=True)
        return self._guess

    def _measure_all(self, first: int) -> None:
        with suppress(ClipError):  # a truncated file is reported when it is drawn
            for end in sorted(range(len(self._clip.intervals) + 1), key=lambda e: abs(e - first)):
                if not self._stopped:
                    self._measured(end)

    def _measured(self, end: int) -> float:
        if end not in self._at_end:
            self._at_end[end] = self._found(end)
        return self._at_end[end]

    def _found(self, end: int, roughly: bool = False) -> float:
        last = end == len(self._clip.intervals)
        interval = self._clip.intervals[end - 1 if last else end]
        every = -(-len(interval) // MOST)
        points = positions_on_curve(interval, slice(None, None, every), 1.0 if last else 0.0)
        # Several movers may start at one point of the scan, so distinct points are counted.
        thinned = every if every == 1 else self._points_at(end) / distinct_count(points)
        found = closing_distance(points, roughly) / math.sqrt(max(thinned, 1.0))
        return found or 2.5 * self._clip.spacing

    def _points_at(self, end: int) -> float:
        """Number of points of the plant at an interval's end, interpolated between scans."""
        intervals, scans = self._clip.intervals, self._clip.scans
        time = intervals[end].start if end < len(intervals) else intervals[-1].end
        return float(np.interp(time, self._clip.times, [scan.points for scan in scans]))


def distinct_count(points: NDArray[np.floating]) -> int:
    """Number of distinct points among (N, 3), at least 1."""
    return max(len(np.unique(morton_codes(points))), 1) if len(points) else 1


def closing_distance(points: NDArray[np.floating], roughly: bool = False) -> float:
    """The radius at which splats on points cover most of the surface that the points lie on.

    points:  (N, 3) on a surface; repeated ones count once.
    roughly: use few places, which is off by some per cent, and do not load scipy.

    Distances between neighbours say little, because a scanner's points lie close together along its
    lines and far apart across them. Instead neighbourhoods are projected to their tangent planes,
    and for random places between three points the distance to the nearest point is found: 19 of 20
    are below the result. Returns 0 for too few points.
    """
    if len(points) == 0:
        return 0.0
    _, first = np.unique(morton_codes(points), return_index=True)
    distinct = np.asarray(points[first], np.float64)
    count = min(NEIGHBORS, len(distinct) - 1)
    if count < 3:
        return 0.0
    random = np.random.default_rng(0)
    nearest, samples = (_one_by_one, ROUGH) if roughly else (_by_tree, SAMPLES)
    chosen = distinct[random.permutation(len(distinct))[:samples]]
    offsets = distinct[nearest(distinct, chosen, count + 1)] - chosen[:, None]
    _, axes = np.linalg.eigh(np.einsum("nki,nkj->nij", offsets, offsets))
    flat = np.einsum("nki,nij->nkj", offsets, axes[:, :, 1:])
    corners = flat[np.arange(len(flat))[:, None], random.integers(0, count + 1, (len(flat), 3))]
    places = np.einsum("nc,ncj->nj", random.dirichlet((1, 1, 1), len(flat)), corners)
    found = np.linalg.norm(flat - places[:, None], axis=2).min(axis=1)
    return float(np.quantile(found, COVERED))


def _by_tree(points: NDArray, chosen: NDArray, count: int) -> NDArray[np.intp]:
    """(N, count) the nearest points of each chosen one."""
    from scipy.spatial import cKDTree

    tree = cKDTree(points, balanced_tree=False, compact_nodes=False)
    return tree.query(chosen, k=count)[1]


def _one_by_one(points: NDArray, chosen: NDArray, count: int) -> NDArray[np.intp]:
    """The same without scipy, whose import takes longer than a few searches."""
    around = np.asarray(points - points.mean(axis=0), np.float32)
    found = []
    for place in np.asarray(chosen - points.mean(axis=0), np.float32):
        squared = ((around - place) ** 2).sum(axis=1)
        found.append(np.argpartition(squared, count - 1)[:count])
    return np.array(found)
