"""Where the organs of an interval are attached to what bears them, in both scans."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from baker.matching import IntervalOrgans, Match
from baker.segmentation.hierarchy import NO_PARENT
from baker.transport.tasks import Task

if TYPE_CHECKING:
    from scipy.spatial import cKDTree


class Foot(Protocol):
    """An organ's point where it is attached in the first scan, foot[0], and in the second one."""

    def __getitem__(self, side: int, /) -> int: ...


class _Sought:
    """A foot that is looked for where it is asked for: that takes a while, and few need both."""

    def __init__(self, find: Callable[[int], int]) -> None:
        self._find = cache(find)

    def __getitem__(self, side: int, /) -> int:
        return self._find(side)


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

    def of(self, task: Task) -> Foot | None:
        """Of a matched organ, the point nearest to its bearer in either scan, counted within it.

        None of the root, and where a bearer has no points.
        """
        if task.event != "match":
            return None
        parents = [
            hierarchy.parents[segment]
            for hierarchy, segment in zip(
                self._hierarchies, self._segments[task.organ], strict=True
            )
        ]
        for hierarchy, parent in zip(self._hierarchies, parents, strict=True):
            if parent == NO_PARENT or not len(hierarchy.segments[parent]):
                return None
        members = task.start, task.end
        return _Sought(lambda side: self._foot(side, parents[side], members[side]))

    def _foot(self, side: int, parent: int, members: NDArray[np.intp]) -> int:
        own = self._clouds[side].take(members, axis=0)
        tree = self._bearer(side, parent)
        return int(np.argmin(tree.query(own)[0]))

    def _bearer(self, side: int, parent: int) -> cKDTree:
        """A bearer's points to search in: many organs may grow from one."""
        from scipy.spatial import cKDTree

        if (side, parent) not in self._bearers:
            members = self._hierarchies[side].segments[parent]
            points = self._clouds[side].take(members, axis=0)
            self._bearers[side, parent] = cKDTree(points, balanced_tree=False)
        return self._bearers[side, parent]
