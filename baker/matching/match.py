"""Match the segments of successive scans (section 3.3 of the paper), and chain them into organs."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from baker.matching.hierarchical import Distance, Points, match_hierarchies
from baker.segmentation.hierarchy import Hierarchy


@dataclass(frozen=True)
class Match:
    """The segments of two successive scans, matched one to one."""

    first: Hierarchy
    second: Hierarchy  # in which matching may have merged segments
    pairs: tuple[tuple[int, int], ...]  # segment of the first scan, segment of the second
    # New organs in the second scan, parents before children; in a pair if they have a primordium.
    births: tuple[int, ...]
    losses: tuple[int, ...]  # unmatched segments of the first scan


def match_from_pairs(
    first: Hierarchy, second: Hierarchy, pairs: Sequence[tuple[int, int]]
) -> Match:
    """Make the match with these pairs; all other segments are born or lost."""
    starts, ends = {a for a, _ in pairs}, {b for _, b in pairs}
    births = tuple(segment for segment in second.parents_first() if segment not in ends)
    losses = tuple(segment for segment in first.parents_first() if segment not in starts)
    return Match(first, second, tuple(sorted(pairs)), births, losses)


def match_by_label(first: Hierarchy, second: Hierarchy) -> Match:
    """Match segments with the same label (section 3.3 of the paper, cases 1 and 2)."""
    ends = {label: index for index, label in enumerate(second.labels)}
    pairs = [(a, ends[label]) for a, label in enumerate(first.labels) if label in ends]
    return match_from_pairs(first, second, pairs)


def match_series(
    clouds: Sequence[Points],
    hierarchies: Sequence[Hierarchy],
    *,
    by_label: bool,
    distance: Distance,
    report_progress: Callable[[int, int], None] = lambda done, total: None,
) -> list[Match]:
    """Match each scan of a series to the next one (section 3.3 of the paper).

    Segments that are merged for one interval stay merged in the next interval.

    clouds: (N, 3) points of each aligned scan. by_label: whether to match by labels, which are then
    consistent, or else by the hierarchies. distance: of two segments, (n, 3) and (m, 3), in length
    units, such as the Wasserstein distance; used to match by the hierarchies. report_progress:
    called with the number of segments matched and their total.
    """
    matches: list[Match] = []
    done, total = 0, sum(len(hierarchy.segments) for hierarchy in hierarchies[1:])

    def report(matched: int) -> None:
        report_progress(done + matched, total)

    report(0)
    first = hierarchies[0]
    for points, second in zip(pairwise(clouds), hierarchies[1:], strict=True):
        if by_label:
            matches.append(match_by_label(first, second))
        else:
            merged, pairs = match_hierarchies(points, (first, second), distance, report)
            matches.append(match_from_pairs(first, merged, pairs))
        done += len(second.segments)
        report(0)
        first = matches[-1].second
    return matches


@dataclass(frozen=True)
class Organ:
    """One organ of the series."""

    label: int | None  # in the first scan with the organ, None without labels
    parent: int | None  # index of the organ that it grows from, None for the root
    first: int  # index of the first scan with the organ
    last: int  # index of the last scan with the organ


def chain_matches(matches: Sequence[Match], consistent: bool) -> tuple[list[Organ], list[Match]]:
    """Chain the matches of successive intervals into organs.

    consistent: whether labels are consistent: a lost organ that reappears is then the same organ.
    Returns the organs by first appearance, the root first, and the matches with the organs of the
    segments in their hierarchies.
    """
    organs: list[Organ] = []
    organ_of_label: dict[int | None, int] = {}

    def with_organs(hierarchy: Hierarchy, scan: int, assigned: dict[int, int]) -> Hierarchy:
        """Assign organs to the segments without one, by consistent labels or else new organs."""
        for segment in hierarchy.parents_first():
            label, parent = hierarchy.labels[segment], hierarchy.parents[segment]
            organ = assigned.get(segment, organ_of_label.get(label) if consistent else None)
            if organ is None:
                organ = len(organs)
                organs.append(Organ(label, assigned.get(parent), scan, scan))
            organs[organ] = replace(organs[organ], last=scan)
            assigned[segment] = organ_of_label[label] = organ
        return replace(hierarchy, organs=tuple(assigned[s] for s in range(len(hierarchy.segments))))

    first, with_tracks = with_organs(matches[0].first, 0, {}), []
    for scan, match in enumerate(matches, start=1):
        matched = {b: first.organs[a] for a, b in match.pairs}
        second = with_organs(match.second, scan, matched)
        with_tracks.append(replace(match, first=first, second=second))
        first = second
    return organs, with_tracks
