"""Organs through the whole series: the matches of successive intervals chained into tracks."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from baker.matching.match import Match
from baker.segmentation.hierarchy import Hierarchy


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
    first = _name(matches[0].first, {}, 0, organs, known)
    for k, match in enumerate(matches, start=1):
        kept = {b: first[a] for a, b in match.pairs}
        second = _name(match.second, kept, k, organs, known)
        intervals.append(IntervalOrgans(first, second))
        first = second
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
