"""Where the organs of an interval are attached to what bears them, in both scans."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.match import IntervalOrgans, Match
from baker.segment.hierarchy import NO_PARENT
from baker.tasks import Task

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

ASKED = 50  # points of an organ that bound how far it is from its bearer


class Feet:
    """Finds the foot of one organ after the other, in any order and from any thread."""

    def __init__(
        self,
        clouds: tuple[NDArray[np.floating], NDArray[np.floating]],
        match: Match,
        organs: IntervalOrgans,
    ) -> None:
        self._clouds = clouds
        self._hierarchies = match.first, match.second
        self._segments = {organs.second[b]: (a, b) for a, b in match.pairs}
        self._bearers: dict[tuple[int, int], cKDTree] = {}

    def of(self, task: Task) -> tuple[int, int] | None:
        """Of a matched organ, the point nearest to its bearer in either scan, counted within it.

        None of the root, and where a bearer has no points.
        """
        if task.event != "match":
            return None
        found = [
            self._foot(side, segment, members)
            for side, (segment, members) in enumerate(
                zip(self._segments[task.organ], (task.start, task.end), strict=True)
            )
        ]
        return None if found[0] is None or found[1] is None else (found[0], found[1])

    def _foot(self, side: int, segment: int, members: NDArray[np.intp]) -> int | None:
        parent = self._hierarchies[side].parents[segment]
        if parent == NO_PARENT or not len(self._hierarchies[side].segments[parent]):
            return None
        own, tree = self._clouds[side][members], self._bearer(side, parent)
        # A few bound the gap, and the search ends there: most points are farther.
        gap = tree.query(own[:: max(1, len(own) // ASKED)])[0].min()
        bound = 1.000001 * float(gap) or np.inf
        return int(np.argmin(tree.query(own, distance_upper_bound=bound)[0]))

    def _bearer(self, side: int, parent: int) -> cKDTree:
        """A bearer's points to search in: many organs may grow from one."""
        from scipy.spatial import cKDTree

        if (side, parent) not in self._bearers:
            points = self._clouds[side][self._hierarchies[side].segments[parent]]
            self._bearers[side, parent] = cKDTree(points)
        return self._bearers[side, parent]
