"""How large discs must be to close a scanned surface."""

from __future__ import annotations

import math
import threading
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from gclip import Clip

SAMPLES = 1500
NEIGHBORS = 48
COVERED = 0.95  # share of the surface
MOST = 40_000  # points of a scan that are looked at: a picture must not wait for more


class ClosingDistances:
    """A clip's closing distance at any time: measured at each interval's ends, linear between.

    So the discs grow and shrink with the surface's density, and never jump.
    """

    def __init__(self, clip: Clip) -> None:
        self._clip = clip
        self._at_end: dict[int, float] = {}
        self._thread: threading.Thread | None = None
        self._stopped = False

    def at(self, index: int, share: float, wait: bool = True) -> float:
        """In the clip's unit; `index` and `share` as `gclip.evaluate.locate` gives them.

        wait: measure now what has not been measured yet; else the nearest time's distance serves
        until a thread, started by the first such question, has measured all.
        """
        first, second = self._end(index, wait), self._end(index + 1, wait)
        return (1.0 - share) * first + share * second

    def release(self) -> None:
        self._stopped = True
        if self._thread is not None:
            self._thread.join()

    def _end(self, end: int, wait: bool) -> float:
        if wait or end in self._at_end or not self._at_end:
            return self._measured(end)
        if self._thread is None:
            self._thread = threading.Thread(target=self._measure_all, args=(end,), daemon=True)
            self._thread.start()
        return self._at_end[min(self._at_end.copy(), key=lambda other: abs(other - end))]

    def _measure_all(self, first: int) -> None:
        for end in sorted(range(len(self._clip.intervals) + 1), key=lambda e: abs(e - first)):
            if not self._stopped:
                self._measured(end)

    def _measured(self, end: int) -> float:
        if end not in self._at_end:
            from gclip.evaluate import positions_on_curve

            last = end == len(self._clip.intervals)
            interval = self._clip.intervals[end - 1 if last else end]
            every = -(-len(interval) // MOST)
            some = slice(None, None, every)
            points = positions_on_curve(interval, some, 1.0 if last else 0.0)
            # Movers may share a point: what is thinned is the scan's points.
            thinned = every if every == 1 else self._points_at(end) / distinct_count(points)
            found = closing_distance(points) / math.sqrt(max(thinned, 1.0))
            self._at_end[end] = found or 2.5 * self._clip.spacing
        return self._at_end[end]

    def _points_at(self, end: int) -> float:
        """How many points the plant has at an interval's end; between scans, as in proportion."""
        intervals, scans = self._clip.intervals, self._clip.scans
        time = intervals[end].start if end < len(intervals) else intervals[-1].end
        return float(np.interp(time, self._clip.times, [scan.points for scan in scans]))


def distinct_count(points: NDArray[np.floating]) -> int:
    """How many different points (N, 3) there are, at least 1."""
    from gclip.pack import morton_codes

    return max(len(np.unique(morton_codes(points))), 1) if len(points) else 1


def closing_distance(points: NDArray[np.floating]) -> float:
    """The radius at which discs on the points cover most of the surface that they lie on.

    points: (N, 3) on a surface; repeated ones count once.

    The distance to the nearest point says little: a scanner's points lie close together along its
    lines, and far apart across them. So the points' neighbourhoods are laid flat, and places
    between three points each ask for the nearest one: 19 of 20 find it within this distance.
    Gives 0 where there are too few points to tell.
    """
    from scipy.spatial import cKDTree

    from gclip.pack import morton_codes

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
    _, neighbors = tree.query(chosen, k=count + 1)
    offsets = distinct[neighbors] - chosen[:, None]
    _, axes = np.linalg.eigh(np.einsum("nki,nkj->nij", offsets, offsets))
    flat = np.einsum("nki,nij->nkj", offsets, axes[:, :, 1:])
    corners = flat[np.arange(len(flat))[:, None], random.integers(0, count + 1, (len(flat), 3))]
    places = np.einsum("nc,ncj->nj", random.dirichlet((1, 1, 1), len(flat)), corners)
    nearest = np.linalg.norm(flat - places[:, None], axis=2).min(axis=1)
    return float(np.quantile(nearest, COVERED))
