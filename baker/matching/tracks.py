"""Organs through the whole series: the matches of successive intervals chained into tracks."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from baker.matching.match import Match
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy


@dataclass(frozen=True)
class Organ:
    """One organ through the series."""

    label: int | None  # in the scan in which it first appears; None where it has none
    parent: int | None  # the organ that it grows from, by index; None for the root
    first: int  # the first and the last scan that hold it
    last: int


@dataclass(frozen=True)
class IntervalOrgans:
    """Which organ each segment of the two hierarchies of an interval's match is."""

    first: dict[int, int]
    second: dict[int, int]


def follow_organs(
    matches: Sequence[Match], consistent: bool
) -> tuple[list[Organ], list[IntervalOrgans]]:
    """Chain the matches of successive intervals into organs.

    Where matching merged segments of a scan for the interval that it starts, the merged segment
    goes on as the organ that its largest part was.

    Parameters
    ----------
    matches : sequence of Match
        Of successive intervals.
    consistent : bool
        Labels name organs: one that was lost and comes back is the same organ again.

    Returns
    -------
    organs : list of Organ
        By first appearance, the root first.
    intervals : list of IntervalOrgans
        One for each interval.
    """
    organs: list[Organ] = []
    known: dict[int | None, int] | None = {} if consistent else None
    intervals: list[IntervalOrgans] = []
    for k, match in enumerate(matches):
        if k == 0:
            first = _name(match.first, {}, 0, organs, known)
        else:
            first = _carried(matches[k - 1].second, intervals[-1].second, match.first)
        kept = {b: first[a] for a, b in match.pairs}
        second = _name(match.second, kept, k + 1, organs, known)
        intervals.append(IntervalOrgans(first, second))
    return organs, intervals


def _name(
    hierarchy: Hierarchy,
    kept: dict[int, int],
    scan: int,
    organs: list[Organ],
    known: dict[int | None, int] | None,
) -> dict[int, int]:
    """The organ of each segment: kept as it is, known by a label that names organs, or new."""
    named = dict(kept)
    for segment in hierarchy.from_the_root():
        label = hierarchy.labels[segment]
        if segment not in named and known is not None and label in known:
            named[segment] = known[label]
        if segment not in named:
            named[segment] = len(organs)
            organs.append(Organ(label, named.get(hierarchy.parents[segment]), scan, scan))
        if known is not None:
            known[label] = named[segment]
        organs[named[segment]] = replace(organs[named[segment]], last=scan)
    return named


def _carried(before: Hierarchy, organs: dict[int, int], after: Hierarchy) -> dict[int, int]:
    """Organs of a scan's segments after merging: that of the largest segment merged into each."""
    home = after.numbers()
    empty_home = next((s for s, m in enumerate(after.segments) if not len(m)), NO_PARENT)
    carried: dict[int, int] = {}
    for segment in sorted(organs, key=lambda s: len(before.segments[s])):
        members = before.segments[segment]
        carried[int(home[members[0]]) if len(members) else empty_home] = organs[segment]
    return carried
