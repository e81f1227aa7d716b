"""Which organ, by its track, is where: what colours the report's pictures, graphs and charts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.pipeline import BakeRecord
from baker.segmentation.hierarchy import Hierarchy


@dataclass(frozen=True)
class ScanOrgans:
    """The organs of one scan.

    points:   (N,) intp, the organ of each point.
    segments: the organ of each segment of the scan as it was segmented; matching may have merged
              several of them into one organ.
    counts:   points of each organ that the scan holds, an empty virtual root among them.
    """

    points: NDArray[np.intp]
    segments: tuple[int, ...]
    counts: dict[int, int]


def organs_of_scans(record: BakeRecord) -> list[ScanOrgans]:
    """The organs of every scan, as the interval that it starts sees it; the last as it ends."""
    sides = [
        *((match.first, named.first) for match, named in _intervals(record)),
        (record.matches[-1].second, record.organs[-1].second),
    ]
    return [
        _scan_organs(found, merged, named)
        for found, (merged, named) in zip(record.hierarchies, sides, strict=True)
    ]


def _intervals(record: BakeRecord) -> zip:
    return zip(record.matches, record.organs, strict=True)


def _scan_organs(found: Hierarchy, merged: Hierarchy, named: dict[int, int]) -> ScanOrgans:
    points = np.empty(sum(len(members) for members in merged.segments), np.intp)
    for segment, members in enumerate(merged.segments):
        points[members] = named[segment]
    counts = {named[s]: len(members) for s, members in enumerate(merged.segments)}
    root = named[merged.root]
    segments = tuple(_most(points[members]) if len(members) else root for members in found.segments)
    return ScanOrgans(points, segments, counts)


def _most(values: NDArray[np.intp]) -> int:
    return int(np.bincount(values).argmax())
