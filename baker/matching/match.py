"""The segments of two successive scans, matched."""

from __future__ import annotations

from dataclasses import dataclass

from baker.segmentation.hierarchy import Hierarchy


@dataclass(frozen=True)
class Merge:
    """A child joined to its parent's segment, because that brought the match nearer.

    side:        0 in the first scan, 1 in the second.
    head, child: segments as the hierarchies number them that matching was given.
    before, after: distance of the matched segments, in length units.
    """

    side: int
    head: int
    child: int
    before: float
    after: float

    def __str__(self) -> str:
        return (
            f"segment {self.child} of the {('first', 'second')[self.side]} scan merged into "
            f"segment {self.head}: distance {self.before:.3g} to {self.after:.3g}"
        )


@dataclass(frozen=True)
class Match:
    """The segments of two successive scans, matched one to one.

    first, second: the hierarchies that the numbers below refer to; matching may have merged
            segments of the hierarchies it was given.
    pairs:  (segment of the first scan, segment of the second).
    births: segments of the second scan that the first does not have, parents before children.
    losses: segments of the first scan that the second no longer has.
    notes:  why segments were matched as they were, one sentence each, for the report.
    merges: what matching merged, in its order.
    """

    first: Hierarchy
    second: Hierarchy
    pairs: tuple[tuple[int, int], ...]
    births: tuple[int, ...]
    losses: tuple[int, ...]
    notes: tuple[str, ...] = ()
    merges: tuple[Merge, ...] = ()

    def start_of(self, end: int) -> int | None:
        """The first scan's segment that becomes segment `end` of the second, if there is one."""
        return next((a for a, b in self.pairs if b == end), None)


def from_pairs(
    first: Hierarchy,
    second: Hierarchy,
    pairs: list[tuple[int, int]],
    merges: tuple[Merge, ...] = (),
) -> Match:
    """The match of these pairs; whatever is in none of them is born or lost."""
    starts, ends = {a for a, _ in pairs}, {b for _, b in pairs}
    return Match(
        first=first,
        second=second,
        pairs=tuple(sorted(pairs)),
        births=tuple(segment for segment in second.from_the_root() if segment not in ends),
        losses=tuple(segment for segment in first.from_the_root() if segment not in starts),
        notes=tuple(map(str, merges)),
        merges=merges,
    )


def match_by_label(first: Hierarchy, second: Hierarchy) -> Match:
    """Consistent labels: the same label is the same organ (section 3.3, cases 1 and 2)."""
    ends = {label: index for index, label in enumerate(second.labels)}
    return from_pairs(
        first, second, [(a, ends[label]) for a, label in enumerate(first.labels) if label in ends]
    )
