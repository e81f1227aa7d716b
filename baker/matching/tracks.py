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


def follow_organs(matches: Sequence[Match], consistent: bool) -> tuple[list[Organ], list[Match]]:
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
    matches : list of Match
        The same, of hierarchies that know the organs of their segments.
    """
    organs: list[Organ] = []
    known: dict[int | None, int] | None = {} if consistent else None
    first = _named(matches[0].first, {}, 0, organs, known)
    followed = []
    for k, match in enumerate(matches, start=1):
        kept = {b: first.organs[a] for a, b in match.pairs}
        second = _named(match.second, kept, k, organs, known)
        followed.append(replace(match, first=first, second=second))
        first = second
    return organs, followed


def _named(
    hierarchy: Hierarchy,
    kept: dict[int, int],
    scan: int,
    organs: list[Organ],
    known: dict[int | None, int] | None,
) -> Hierarchy:
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
    return replace(hierarchy, organs=tuple(named[s] for s in range(len(hierarchy.segments))))
