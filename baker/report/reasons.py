"""Why a segment was matched as it was: how near it lay to what it could have become."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.pipeline import BakeRecord
from baker.report.organs import ScanOrgans
from baker.segmentation.hierarchy import Hierarchy
from gclip import Clip, SegmentPair

SAMPLE = 400  # points of a segment that distances are measured with
MOST = 2500  # pairs of segments up to which all distances are measured


@dataclass(frozen=True)
class Nearness:
    """Mean distances between an interval's segments, in the scans' unit.

    distances: (n, m) from the points of the first scan's organ `rows[i]` to the nearest ones of
               the second's `columns[j]`: an organ that grows covers what it was.
    """

    rows: tuple[int, ...]
    columns: tuple[int, ...]
    distances: NDArray[np.float64]

    def between(self, first: int, second: int) -> float:
        return float(self.distances[self.rows.index(first), self.columns.index(second)])

    def next_best(self, organ: int) -> tuple[int, float] | None:
        """The other organ of the second scan that lay nearest to `organ`, and how far."""
        if organ not in self.rows:
            return None
        others = [(d, c) for c, d in self._row(organ) if c != organ]
        return (min(others)[1], min(others)[0]) if others else None

    def _row(self, organ: int) -> list[tuple[int, float]]:
        row = self.distances[self.rows.index(organ)]
        return [(column, float(d)) for column, d in zip(self.columns, row, strict=True)]


@dataclass(frozen=True)
class Reason:
    """One segment's way through an interval, and why it was this one.

    labels: what the two scans' own labels call it, None where they don't.
    apart:  how near what it was is to what it becomes; `other` the organ of the second scan that
            is nearest else, and how near. None where unknown.
    host:   for a birth, the organ whose points are the bud; `bud` (3,) the middle of them.
    """

    pair: SegmentPair
    labels: tuple[int, int] | None = None
    apart: float | None = None
    other: tuple[int, float] | None = None
    host: int | None = None
    bud: NDArray[np.float64] | None = None


def nearness(record: BakeRecord, interval: int) -> Nearness | None:
    """How near an interval's segments are to each other; None where there are too many."""
    from scipy.spatial import cKDTree

    match, named = record.matches[interval], record.organs[interval]
    rows, first = _clouds(match.first, named.first, record.keyframes[interval].positions)
    columns, second = _clouds(match.second, named.second, record.keyframes[interval + 1].positions)
    if len(rows) * len(columns) > MOST:
        return None
    trees = [cKDTree(cloud) for cloud in second]
    distances = [[tree.query(_sample(cloud))[0].mean() for tree in trees] for cloud in first]
    return Nearness(rows, columns, np.array(distances).reshape(len(rows), len(columns)))


def reasons(
    clip: Clip, record: BakeRecord, interval: int, scan: ScanOrgans, near: Nearness | None
) -> list[Reason]:
    """For each segment pair of an interval, in its order, why it is a pair.

    scan: the organs of the interval's first scan; near: of the same interval, None if unknown.
    """
    labels, buds = _labels(record, interval), _buds(record, interval, scan)
    found = []
    for pair in clip.intervals[interval].segments:
        organ = pair.track
        known = near is not None and organ in near.rows and organ in near.columns
        if pair.event == "birth":
            host, bud = buds[organ]
            found.append(Reason(pair, host=host, bud=bud))
        elif pair.event == "match" and near is not None and known:
            apart, other = near.between(organ, organ), near.next_best(organ)
            found.append(Reason(pair, labels.get(organ), apart, other))
        else:
            found.append(Reason(pair, labels.get(organ) if pair.event == "match" else None))
    return found


def _labels(record: BakeRecord, interval: int) -> dict[int, tuple[int, int]]:
    """By organ, what the scans' own labels called the two segments that were matched."""
    match, named = record.matches[interval], record.organs[interval]
    first, second = (record.series.scans[k].labels for k in (interval, interval + 1))
    if first is None or second is None:
        return {}
    called = {}
    for a, b in match.pairs:
        before, after = match.first.segments[a], match.second.segments[b]
        if len(before) and len(after):
            called[named.second[b]] = _most(first[before]), _most(second[after])
    return called


def _buds(
    record: BakeRecord, interval: int, scan: ScanOrgans
) -> dict[int, tuple[int, NDArray[np.float64]]]:
    """By organ that is born: the organ whose points are its bud, and the middle of them."""
    first = record.keyframes[interval].positions
    return {
        task.organ: (_most(scan.points[task.start]), first[task.start].mean(axis=0, dtype=float))
        for task in record.tasks[interval]
        if task.event == "birth"
    }


def _most(values: NDArray[np.integer]) -> int:
    found, counts = np.unique(values, return_counts=True)
    return int(found[counts.argmax()])


def _clouds(
    hierarchy: Hierarchy, named: dict[int, int], points: NDArray[np.floating]
) -> tuple[tuple[int, ...], list[NDArray[np.floating]]]:
    """Organs that have points, by number, and the points of each."""
    held = sorted((named[s], s) for s, members in enumerate(hierarchy.segments) if len(members))
    return tuple(organ for organ, _ in held), [points[hierarchy.segments[s]] for _, s in held]


def _sample(cloud: NDArray[np.floating]) -> NDArray[np.floating]:
    return cloud[:: -(-len(cloud) // SAMPLE)]
