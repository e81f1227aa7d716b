"""Which segment becomes which from scan to scan (paper section 3.3), and the organs' tracks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from baker.segment.hierarchy import Hierarchy


@dataclass(frozen=True)
class Match:
    """The segments of two successive scans, matched one to one.

    pairs:  (segment of the first scan, segment of the second).
    births: segments of the second scan that the first does not have, parents before children.
    losses: segments of the first scan that the second no longer has.
    """

    pairs: tuple[tuple[int, int], ...]
    births: tuple[int, ...]
    losses: tuple[int, ...]

    def start_of(self, end: int) -> int | None:
        """The first scan's segment that becomes segment `end` of the second, if there is one."""
        return next((a for a, b in self.pairs if b == end), None)


@dataclass(frozen=True)
class Organ:
    """One organ through the whole series.

    segments: index of its segment in each scan that holds it, by scan.
    parent:   the organ it grows from when it first appears, as an index into the organs.
    """

    label: int | None
    segments: dict[int, int] = field(default_factory=dict)
    parent: int | None = None


def match_by_label(first: Hierarchy, second: Hierarchy) -> Match:
    """Consistent labels: the same label is the same organ (section 3.3, cases 1 and 2)."""
    starts = {label: index for index, label in enumerate(first.labels)}
    ends = {label: index for index, label in enumerate(second.labels)}
    depth = [len(second.ancestors(index)) for index in range(len(second.segments))]
    return Match(
        pairs=tuple((starts[label], ends[label]) for label in first.labels if label in ends),
        births=tuple(
            sorted((i for label, i in ends.items() if label not in starts), key=depth.__getitem__)
        ),
        losses=tuple(i for label, i in starts.items() if label not in ends),
    )


def follow_organs(
    hierarchies: Sequence[Hierarchy], matches: Sequence[Match], consistent: bool
) -> list[Organ]:
    """Chain the matches of successive scans into organs, the root first, then by first appearance.

    consistent: labels name organs, so one that was lost and comes back is the same organ again.
    """
    organs: list[Organ] = []
    by_label: dict[int | None, int] = {}
    current: dict[int, int] = {}
    for scan, hierarchy in enumerate(hierarchies):
        previous, current = current, {}
        if scan:
            current = {b: previous[a] for a, b in matches[scan - 1].pairs}
        for segment in _from_the_root(hierarchy):
            if segment not in current:
                label = hierarchy.labels[segment]
                if not consistent or label not in by_label:
                    by_label[label] = len(organs)
                    organs.append(Organ(label, {}, _parent(hierarchy, segment, current)))
                current[segment] = by_label[label]
            organs[current[segment]].segments[scan] = segment
    return organs


def _from_the_root(hierarchy: Hierarchy) -> list[int]:
    return sorted(range(len(hierarchy.segments)), key=lambda s: (len(hierarchy.ancestors(s)), s))


def _parent(hierarchy: Hierarchy, segment: int, organs: dict[int, int]) -> int | None:
    parent = hierarchy.parents[segment]
    return organs.get(parent)
