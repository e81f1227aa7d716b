"""Why a segment was matched as it was: how near it lay to what it could have become."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.record import BakeRecord
from baker.report.organs import ScanOrgans
from baker.segment.hierarchy import Hierarchy
from baker.tasks import interval_tasks
from gclip.clip import Clip, SegmentPair

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

    host: for a birth, the organ whose points are the bud.
    """

    pair: SegmentPair
    why: str
    host: int | None = None


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
    labels, hosts = _labels(record, interval), _hosts(record, interval, scan)
    found = []
    for pair in clip.intervals[interval].segments:
        if pair.event == "birth":
            bud = f"new: unfolds from a bud of {pair.start_points} points"
            found.append(Reason(pair, bud, hosts.get(pair.track)))
        elif pair.event == "loss":
            found.append(Reason(pair, "no segment of the next scan is this organ"))
        else:
            found.append(Reason(pair, _why(pair.track, labels.get(pair.track), near)))
    return found


def _why(organ: int, label: str | None, near: Nearness | None) -> str:
    said = [] if label is None else [label]
    if near is not None and organ in near.rows and organ in near.columns:
        own, other = near.between(organ, organ), near.next_best(organ)
        said.append(f"{own:.3g} apart")
        if other is not None and other[1] < own:
            said.append(f"although organ {other[0]} is nearer, {other[1]:.3g}")
        elif other is not None:
            said.append(f"next nearest organ {other[0]}, {other[1]:.3g}")
    return "; ".join(said)


def _labels(record: BakeRecord, interval: int) -> dict[int, str]:
    """By organ, what the scans' own labels called the two segments that were matched."""
    match, named = record.matches[interval], record.organs[interval]
    first, second = (record.series.scans[k].labels for k in (interval, interval + 1))
    if first is None or second is None:
        return {}
    said = {}
    for a, b in match.pairs:
        before, after = match.first.segments[a], match.second.segments[b]
        if len(before) and len(after):
            one, other = _most(first[before]), _most(second[after])
            same = f"label {one} in both scans"
            said[named.second[b]] = same if one == other else f"label {one}, then {other}"
    return said


def _hosts(record: BakeRecord, interval: int, scan: ScanOrgans) -> dict[int, int]:
    """By organ that is born, the organ whose points are its bud."""
    frames = record.keyframes[interval : interval + 2]
    clouds = frames[0].positions, frames[1].positions
    tasks = interval_tasks(clouds, record.matches[interval], record.organs[interval])
    return {task.organ: _most(scan.points[task.start]) for task in tasks if task.event == "birth"}


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
