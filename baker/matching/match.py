"""The segments of successive scans, matched (paper section 3.3), and organs through the series."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from baker.matching.hierarchical import Distance, Points, match_hierarchies
from baker.segmentation.hierarchy import Hierarchy


@dataclass(frozen=True)
class Match:
    """The segments of two successive scans, matched one to one.

    Matching may have merged segments of the second hierarchy that it was given.
    """

    first: Hierarchy
    second: Hierarchy
    pairs: tuple[tuple[int, int], ...]  # segment of the first scan, segment of the second
    births: tuple[int, ...]  # new segments of the second scan, parents before their children
    losses: tuple[int, ...]  # segments of the first scan that the second no longer has

    def start_of(self, end: int) -> int | None:
        """The first scan's segment that becomes segment `end` of the second, if there is one."""
        return next((a for a, b in self.pairs if b == end), None)


def match_from_pairs(
    first: Hierarchy, second: Hierarchy, pairs: Sequence[tuple[int, int]]
) -> Match:
    """The match of these pairs; every other segment is born or lost."""
    starts, ends = {a for a, _ in pairs}, {b for _, b in pairs}
    return Match(
        first=first,
        second=second,
        pairs=tuple(sorted(pairs)),
        births=tuple(segment for segment in second.from_the_root() if segment not in ends),
        losses=tuple(segment for segment in first.from_the_root() if segment not in starts),
    )


def match_by_label(first: Hierarchy, second: Hierarchy) -> Match:
    """Consistent labels: the same label is the same organ (section 3.3, cases 1 and 2)."""
    ends = {label: index for index, label in enumerate(second.labels)}
    return match_from_pairs(
        first, second, [(a, ends[label]) for a, label in enumerate(first.labels) if label in ends]
    )


def match_series(
    clouds: Sequence[Points],
    hierarchies: Sequence[Hierarchy],
    *,
    by_label: bool,
    distance: Distance,
    report_progress: Callable[[int, int], None] = lambda done, total: None,
) -> list[Match]:
    """Match each scan of a series to the next one.

    What is merged in a scan for the interval before it stays merged in the interval after it.

    Parameters
    ----------
    clouds : sequence of (N, 3) float ndarray
        The aligned scans.
    hierarchies : sequence of Hierarchy
    by_label : bool
        Labels are consistent: match by them. Else match down the hierarchies.
    distance : callable
        Of two segments, (n, 3) and (m, 3), in length units; for matching down the hierarchies. The
        pipeline chooses it: the Wasserstein distance.
    report_progress : callable
        Called with the number of segments matched and the number of all.

    References
    ----------
    Section 3.3 of the paper.
    """
    matches: list[Match] = []
    sizes = [len(hierarchy.segments) for hierarchy in hierarchies[1:]]
    report_progress(0, sum(sizes))
    for k, following in enumerate(hierarchies[1:]):
        current = matches[-1].second if matches else hierarchies[0]
        if by_label:
            matches.append(match_by_label(current, following))
        else:
            report = partial(_report, report_progress, sum(sizes[:k]), sum(sizes))
            merged, pairs = match_hierarchies(
                (clouds[k], clouds[k + 1]), (current, following), distance, report
            )
            matches.append(match_from_pairs(current, merged, pairs))
        report_progress(sum(sizes[: k + 1]), sum(sizes))
    return matches


def _report(report: Callable[[int, int], None], before: int, total: int, matched: int) -> None:
    report(before + matched, total)


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
