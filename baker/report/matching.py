"""Why segments were matched as they were: the distances to what they could have become."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.pipeline import BakeRecord
from baker.report.organs import ScanOrgans, most_frequent
from baker.segmentation.hierarchy import Hierarchy
from gclip import Clip, SegmentPair

SAMPLE_SIZE = 400  # points of a segment that distances are measured from
MAX_PAIRS = 2500  # of segments, up to which all distances are measured

OrganDistances = Mapping[int, Mapping[int, float]]  # of the first scan's organs to the second's


@dataclass(frozen=True)
class Reason:
    """A segment pair, and why it is one; None where that is unknown."""

    pair: SegmentPair
    labels: tuple[int, int] | None = None  #: what the two scans' own labels call it
    distance: float | None = None  #: from what it was to what it becomes: see `organ_distances`
    nearest_other: tuple[int, float] | None = None  #: organ of the second scan, and its distance
    parent: int | None = None  #: of a birth: the organ that it unfolds from
    attachment: NDArray[np.float64] | None = None  #: and (3,) the middle of its attachment points


def organ_distances(record: BakeRecord, interval: int) -> OrganDistances:
    """Mean distance of each organ of an interval's first scan to each of the second.

    It is the mean over the first one's points of the distance to the nearest of the second's, in
    the scans' unit: small for an organ that grows, which covers what it was. Nothing is measured
    of more than `MAX_PAIRS` pairs.
    """
    from scipy.spatial import cKDTree

    match, organs = record.matches[interval], record.organs[interval]
    first = _clouds(match.first, organs.first, record.keyframes[interval].positions)
    second = _clouds(match.second, organs.second, record.keyframes[interval + 1].positions)
    if len(first) * len(second) > MAX_PAIRS:
        return {}
    trees = {organ: cKDTree(cloud) for organ, cloud in second.items()}
    return {
        organ: {other: float(tree.query(sample)[0].mean()) for other, tree in trees.items()}
        for organ, cloud in first.items()
        for sample in [cloud[:: -(-len(cloud) // SAMPLE_SIZE)]]
    }


def reasons(
    clip: Clip, record: BakeRecord, interval: int, scan: ScanOrgans, distances: OrganDistances
) -> list[Reason]:
    """For each segment pair of an interval, in its order, why it is a pair.

    scan: the organs of the interval's first scan. distances: of the interval.
    """
    points, labels = record.keyframes[interval].positions, _labels(record, interval)
    starts = {task.organ: task.start for task in record.tasks[interval] if task.event == "birth"}
    found = []
    for pair in clip.intervals[interval].segments:
        if pair.event == "birth":
            start = starts[pair.track]
            middle = points[start].mean(axis=0, dtype=float)
            found.append(Reason(pair, None, None, None, most_frequent(scan.points[start]), middle))
        elif pair.event == "match":
            row = distances.get(pair.track, {})
            others = sorted((d, organ) for organ, d in row.items() if organ != pair.track)
            other = others[0][::-1] if others else None
            found.append(Reason(pair, labels.get(pair.track), row.get(pair.track), other))
        else:
            found.append(Reason(pair))
    return found


def _labels(record: BakeRecord, interval: int) -> dict[int, tuple[int, int]]:
    """By organ, what the scans' own labels called the two segments that were matched."""
    match, organs = record.matches[interval], record.organs[interval]
    first, second = (record.series.scans[k].labels for k in (interval, interval + 1))
    if first is None or second is None:
        return {}
    members = {b: (match.first.segments[a], match.second.segments[b]) for a, b in match.pairs}
    return {
        organs.second[b]: (most_frequent(first[start]), most_frequent(second[end]))
        for b, (start, end) in members.items()
        if len(start) and len(end)
    }


def _clouds(
    hierarchy: Hierarchy, organ_of: Mapping[int, int], points: NDArray[np.floating]
) -> dict[int, NDArray[np.floating]]:
    """The points of each organ that has any, in the order of the organs."""
    members = {organ_of[segment]: own for segment, own in enumerate(hierarchy.segments) if len(own)}
    return {organ: points[members[organ]] for organ in sorted(members)}
