"""How far a new organ has unfolded half-way through the interval that it is born in.

What a scan does not show yet may appear at any time before the next. How fast the organ grows
afterwards suggests when: drawn back, its growth gives the size that it had half-way, less than a
half of what it is at the end where it comes late and fast. What is small at the end may have been
there at the start and too small to be seen; what is large was not, and had a half at most.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.interpolation.growth_rate import Pace
from baker.matching import IntervalOrgans, Match
from baker.segmentation.hierarchy import NO_PARENT

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

LATE, EVEN = 0.45, 0.5  # births later than that were farther from scans left out
SEEN = 10  # points from which on an organ is seen in a scan
AT_BASE = 0.02  # share of an organ's points that are its base


@dataclass(frozen=True)
class Birth:
    """How an organ unfolds.

    base: (3,) where it is attached at the end; size: its share of its size half-way.
    pace: of what bears it; None where that goes evenly.
    """

    base: NDArray[np.float64]
    size: float
    pace: Pace | None = None

    def control(
        self, start: NDArray[np.floating], end: NDArray[np.floating]
    ) -> NDArray[np.float32]:
        """(N, 3) control points: half-way each mover is `size` of the way from the base to its end.

        The base itself is as far from bud to attachment then as what bears it is on its way.
        """
        unfolding = start / 2 + (1 - 2 * self.size) * self.base + (2 * self.size - 0.5) * end
        if self.pace is not None:
            unfolding = unfolding + 2 * self.pace.shift(start, self.base)
        return unfolding.astype(np.float32)


def births(
    clouds: Sequence[NDArray[np.floating]],
    matches: Sequence[Match],
    organs: Sequence[IntervalOrgans],
    times: Sequence[float],
    paces: Sequence[Mapping[int, Pace]],
) -> list[dict[int, Birth]]:
    """For each interval, by organ, how those that are born in it unfold.

    paces: of each interval, by organ, as `baker.interpolation.growth_rate` finds them.

    All that unfolds from one bud does so as one piece. Where nothing tells how an organ goes on to
    grow, the series' other births do.
    """
    spans = np.diff(times)
    attached = [_Attachments(*scan) for scan in zip(clouds[1:], matches, strict=True)]
    found = []
    unfolding = [(k, top) for k, match in enumerate(matches) for top in sorted(_tops(match))]
    places = [attached[k].base(top) for k, top in unfolding]
    for k in range(len(matches)):
        bases = {top: place for (at, top), place in zip(unfolding, places, strict=True) if at == k}
        sizes = {
            top: _size_half_way(attached, organs, spans, k, top, base)
            for top, base in bases.items()
        }
        found.append((bases, sizes))
    known = [size for _, sizes in found for size in sizes.values() if size is not None]
    usual = float(np.median(known)) if known else EVEN
    born = []
    for match, named, paced, (bases, sizes) in zip(matches, organs, paces, found, strict=True):
        tops = _tops_of_births(match)
        pace = {top: _pace_of_bearer(top, match, named, paced) for top in bases}
        born.append(
            {
                named.second[segment]: Birth(
                    bases[top], sizes[top] or min(usual, _most(match, top)), pace[top]
                )
                for segment, top in tops.items()
            }
        )
    return born


def _tops_of_births(match: Match) -> dict[int, int]:
    """Each born segment, and the born segment nearest to the root that it unfolds with."""
    new = set(match.births)
    return {
        segment: next(
            (
                s
                for s in reversed([segment, *match.second.ancestors(segment)])
                if _opens(s, match, new)
            ),
            segment,
        )
        for segment in match.births
        if len(match.second.segments[segment])
    }


def _opens(segment: int, match: Match, new: set[int]) -> bool:
    """Whether a born segment with points grows on one that was there before, or on nothing."""
    parent = match.second.parents[segment]
    return segment in new and parent not in new and bool(len(match.second.segments[segment]))


def _pace_of_bearer(
    segment: int, match: Match, named: IntervalOrgans, paces: Mapping[int, Pace]
) -> Pace | None:
    parent = match.second.parents[segment]
    return None if parent == NO_PARENT else paces.get(named.second[parent])


def _tops(match: Match) -> set[int]:
    return set(_tops_of_births(match).values())


class _Attachments:
    """Where the organs of an interval's second scan are attached, and how far they reach."""

    def __init__(self, cloud: NDArray[np.floating], match: Match) -> None:
        self.match = match
        self._cloud = cloud
        self._bearers: dict[int, cKDTree] = {}

    def base(self, segment: int) -> NDArray[np.float64]:
        """(3,) the middle of the segment's points nearest to what it grows from."""
        own = self._points(segment)
        bearer = self._bearer(self.match.second.parents[segment])
        count = max(1, round(AT_BASE * len(own)))
        apart = bearer.query(own)[0]
        return own[np.argsort(apart, kind="stable")[:count]].mean(axis=0)

    def extent(self, segment: int, base: NDArray[np.float64]) -> float:
        return float(np.sqrt(((self._points(segment) - base) ** 2).sum(axis=1).mean()))

    def _points(self, segment: int) -> NDArray[np.float64]:
        members = self.match.second.segments[segment]
        return self._cloud.take(members, axis=0).astype(float)

    def _bearer(self, parent: int) -> cKDTree:
        """A parent's points to search in: many organs may grow from one."""
        from scipy.spatial import cKDTree

        if parent not in self._bearers:
            members = self.match.second.segments[parent] if parent != NO_PARENT else ()
            points = self._cloud[members] if len(members) else np.median(self._cloud, 0)[None]
            self._bearers[parent] = cKDTree(points, balanced_tree=False)
        return self._bearers[parent]


def _size_half_way(
    attached: Sequence[_Attachments],
    organs: Sequence[IntervalOrgans],
    spans: NDArray[np.float64],
    k: int,
    top: int,
    base: NDArray[np.float64],
) -> float | None:
    """The organ's size half-way as a share of its size at the end, None where nothing tells."""
    if k + 1 >= len(attached):
        return None
    following, organ = attached[k + 1], organs[k].second[top]
    named = organs[k + 1].second
    later = next((b for _, b in following.match.pairs if named[b] == organ), None)
    if later is None:
        return None
    size = attached[k].extent(top, base)
    grown = following.extent(later, following.base(later))
    growth = (grown / max(size, 1e-12) - 1) * spans[k] / (2 * spans[k + 1])
    return float(np.clip(1 - growth, LATE, _most(attached[k].match, top)))


def _most(match: Match, top: int) -> float:
    """The largest that an organ not seen before can be half-way, as a share of its end's size.

    It may have been of any size at which it would not have been seen: of half of that.
    """
    unseen = min(1.0, (SEEN / len(match.second.segments[top])) ** 0.5)
    return EVEN + (1 - EVEN) * unseen / 2
