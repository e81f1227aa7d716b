"""Which organ, by its track, each point and segment is, and which segments matching merged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.pipeline import BakeRecord
from baker.segmentation.hierarchy import Hierarchy


@dataclass(frozen=True)
class ScanOrgans:
    """The organs of one scan."""

    points: NDArray[np.intp]  #: (N,) the organ of each point
    segments: tuple[int, ...]  #: the organ of each segment, as they were before matching merged any
    counts: dict[int, int]  #: points of each organ that the scan holds, an empty root among them


@dataclass(frozen=True)
class MergedSegments:
    """A segment merged with its parent, because the match then had a smaller distance."""

    scan: int
    are_organs: bool  #: whether `parent` and `child` are organs; else segments of the scan
    parent: int
    child: int
    into: int  #: the organ that they are together
    before: float  #: distance of the match, in the scans' unit
    after: float


def organs_of_scans(record: BakeRecord) -> list[ScanOrgans]:
    """The organs of every scan, as the interval that it starts sees it; the last as it ends."""
    intervals = zip(record.matches, record.organs, strict=True)
    sides = [(match.first, organs.first) for match, organs in intervals]
    sides.append((record.matches[-1].second, record.organs[-1].second))
    scans = []
    for found, (merged, organ_of) in zip(record.hierarchies, sides, strict=True):
        tracks = np.array([organ_of[segment] for segment in range(len(merged.segments))], np.intp)
        points = tracks[merged.numbers()]
        segments = tuple(
            most_frequent(points[members]) if len(members) else organ_of[merged.root]
            for members in found.segments
        )
        counts = {organ_of[s]: len(members) for s, members in enumerate(merged.segments)}
        scans.append(ScanOrgans(points, segments, counts))
    return scans


def merged_segments(record: BakeRecord, interval: int) -> list[MergedSegments]:
    """What was merged for an interval's match, in the order of merging."""
    match, organs = record.matches[interval], record.organs[interval]
    ends = (match.first, organs.first), (match.second, organs.second)
    found = []
    for merge in match.merges:
        scan, parts = interval + merge.side, (merge.head, merge.child)
        before, are_organs = record.hierarchies[scan], scan == interval > 0
        if are_organs:
            before, organ_of = record.matches[scan - 1].second, record.organs[scan - 1].second
            parts = (organ_of[merge.head], organ_of[merge.child])
        merged, organ_of = ends[merge.side]
        into = organ_of[_segment_in(merged, before, merge.head)]
        found.append(MergedSegments(scan, are_organs, *parts, into, merge.before, merge.after))
    return found


def absorbed_organs(record: BakeRecord, interval: int) -> dict[int, int]:
    """Organs that ended the interval before this one and are part of another one in it, by both."""
    if interval == 0:
        return {}
    before, organ_before = record.matches[interval - 1].second, record.organs[interval - 1].second
    after, organ_after = record.matches[interval].first, record.organs[interval].first
    whole = {
        organ: organ_after[_segment_in(after, before, segment)]
        for segment, organ in organ_before.items()
    }
    return {organ: into for organ, into in whole.items() if organ not in organ_after.values()}


def most_frequent(values: NDArray[np.integer]) -> int:
    """The value that most of (N,) integers have; the lowest of several."""
    found, counts = np.unique(values, return_counts=True)
    return int(found[counts.argmax()])


def _segment_in(merged: Hierarchy, before: Hierarchy, segment: int) -> int:
    """The segment of `merged` that holds the points of a segment of `before`."""
    members = before.segments[segment]
    if not len(members):
        return merged.root
    return next(s for s, own in enumerate(merged.segments) if members[0] in own)
