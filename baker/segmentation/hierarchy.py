"""The segment hierarchy of one scan (paper section 3.2): which organ grows from which."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

NO_PARENT = -1


@dataclass(frozen=True)
class Hierarchy:
    """A scan's points split into segments, the segments hung into a tree.

    segments: point indices of each segment, (n,) intp each; together every point exactly once.
              A virtual root has no points.
    labels:   the segment's label in the scan; None where it has none (a virtual root).
    parents:  index of the segment it grows from, NO_PARENT for the root.
    root:     index of the root segment.
    notes:    sentences for the user (gaps bridged, a virtual root).
    organs:   which organ of the series each segment is, once these are followed.
    """

    segments: tuple[NDArray[np.intp], ...]
    labels: tuple[int | None, ...]
    parents: tuple[int, ...]
    root: int
    notes: tuple[str, ...] = ()
    organs: tuple[int, ...] = ()

    def numbers(self) -> NDArray[np.int64]:
        """(N,) the segment of each point."""
        numbers = np.empty(sum(len(members) for members in self.segments), np.int64)
        for index, members in enumerate(self.segments):
            numbers[members] = index
        return numbers

    def children(self, segment: int) -> list[int]:
        return [child for child, parent in enumerate(self.parents) if parent == segment]

    def ancestors(self, segment: int) -> list[int]:
        """From the segment's parent up to the root."""
        chain = []
        while (segment := self.parents[segment]) != NO_PARENT:
            chain.append(segment)
        return chain

    def merged(self, groups: Sequence[Sequence[int]]) -> "Hierarchy":
        """The hierarchy with each group of segments as one; a group's head, its first, names it.

        groups: together every segment exactly once, each group's segments joined to its head.
        """
        home = {segment: index for index, group in enumerate(groups) for segment in group}
        heads = [group[0] for group in groups]
        parents = [self.parents[head] for head in heads]
        return Hierarchy(
            segments=tuple(
                np.sort(np.concatenate([self.segments[segment] for segment in group]))
                for group in groups
            ),
            labels=tuple(self.labels[head] for head in heads),
            parents=tuple(p if p == NO_PARENT else home[p] for p in parents),
            root=home[self.root],
            notes=self.notes,
        )

    def from_the_root(self) -> list[int]:
        """All segments, parents before their children."""
        depth = [len(self.ancestors(segment)) for segment in range(len(self.segments))]
        return sorted(range(len(self.segments)), key=depth.__getitem__)


def one_segment(points: int) -> Hierarchy:
    """All points as one segment (the paper's Figure 3)."""
    return Hierarchy((np.arange(points),), (0,), (NO_PARENT,), 0)


def split_by_label(labels: NDArray[np.integer]) -> tuple[list[int], list[NDArray[np.intp]]]:
    """The distinct labels, ascending, and the point indices that bear each of them."""
    names, owner = np.unique(labels, return_inverse=True)
    short = owner.astype(np.int16) if len(names) <= 2**15 else owner  # sorted in a quarter the time
    order = np.argsort(short, kind="stable")
    return names.tolist(), np.split(order, np.cumsum(np.bincount(owner))[:-1])
