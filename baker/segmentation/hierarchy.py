"""The hierarchy of the segments of one scan (section 3.2 of the paper)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

NO_PARENT = -1  # the parent of a root


@dataclass(frozen=True)
class Hierarchy:
    """A tree of segments, which partition the points of a scan."""

    segments: tuple[NDArray[np.intp], ...]  # (n,) indices of points; of a virtual root none
    labels: tuple[int | None, ...]  # in the scan; None for a virtual root, or without labels
    parents: tuple[int, ...]  # index of the segment that each one grows from, or NO_PARENT
    root: int  # index of the root segment
    notes: tuple[str, ...] = ()  # sentences for the user (gaps bridged, a virtual root)
    organs: tuple[int, ...] = ()  # track id of each segment, once organs are tracked

    def numbers(self) -> NDArray[np.int64]:
        """(N,) the index of each point's segment."""
        numbers = np.empty(sum(len(members) for members in self.segments), np.int64)
        for index, members in enumerate(self.segments):
            numbers[members] = index
        return numbers

    def children(self, segment: int) -> list[int]:
        """The segments that grow from a segment."""
        return [child for child, parent in enumerate(self.parents) if parent == segment]

    def ancestors(self, segment: int) -> list[int]:
        """The ancestors of a segment, from its parent to the root."""
        chain = []
        while (segment := self.parents[segment]) != NO_PARENT:
            chain.append(segment)
        return chain

    def merged(self, groups: Sequence[Sequence[int]]) -> "Hierarchy":
        """Merge each group of segments into one, with the label and parent of its first segment.

        groups: a partition of the segments.
        """
        merged = {segment: index for index, group in enumerate(groups) for segment in group}
        members = [np.concatenate([self.segments[segment] for segment in g]) for g in groups]
        heads = [group[0] for group in groups]
        parents = [self.parents[head] for head in heads]
        return Hierarchy(
            segments=tuple(map(np.sort, members)),
            labels=tuple(self.labels[head] for head in heads),
            parents=tuple(p if p == NO_PARENT else merged[p] for p in parents),
            root=merged[self.root],
            notes=self.notes,
        )

    def parents_first(self) -> list[int]:
        """All segments, sorted so that parents precede their children."""
        depth = [len(self.ancestors(segment)) for segment in range(len(self.segments))]
        return sorted(range(len(self.segments)), key=depth.__getitem__)


def split_by_label(labels: NDArray[np.integer]) -> tuple[list[int], list[NDArray[np.intp]]]:
    """Group (N,) points by their labels.

    Returns the distinct labels in ascending order and, for each one, the ascending (n,) indices of
    its points: ``[np.flatnonzero(labels == label) for label in np.unique(labels)]``.
    """
    distinct, index = np.unique(labels, return_inverse=True)
    kind = np.int16 if len(distinct) <= 2**15 else np.int64  # the former sorts 4 times as fast
    order = np.argsort(index.astype(kind), kind="stable")
    return distinct.tolist(), np.split(order, np.cumsum(np.bincount(index))[:-1])
