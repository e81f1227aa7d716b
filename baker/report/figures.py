"""What the report shows of scans and intervals, and of which states it asks for pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from baker.pipeline import BakeRecord
from baker.report.errormap import ErrorScale
from baker.report.graph import Graph, draw_over, draw_tree, segment_centers
from baker.report.matching import OrganDistances, Reason, organ_distances, reasons
from baker.report.organs import MergedSegments, ScanOrgans, absorbed_organs, merged_segments
from baker.report.pictures import Picture, PictureRequest, Window
from baker.report.verification import HoldoutError
from gclip import Clip

NEUTRAL_COLOR = (122, 146, 110)  # of scans without colours, where organs don't matter
MAX_PICTURED_INTERVALS = 12  # up to which the state half-way through each is pictured too


@dataclass(frozen=True)
class IntervalFigure:
    """One interval: each segment pair, and why it is one."""

    reasons: list[Reason]
    merges: list[MergedSegments]
    distances: OrganDistances

    @property
    def cost(self) -> float:
        """Root mean square of the matched pairs' costs, weighed by their movers."""
        pairs = [reason.pair for reason in self.reasons if reason.pair.event == "match"]
        total = sum(pair.movers for pair in pairs) or 1
        return float(sum(pair.movers * pair.cost**2 for pair in pairs) / total) ** 0.5


@dataclass(frozen=True)
class ScanFigure:
    """One scan: its hierarchy as a graph, alone and over the plant's picture where there is one."""

    organs: ScanOrgans
    absorbed: dict[int, int]  #: organs that are part of another one from this scan on, and of which
    tree: Graph
    over: Graph | None
    attachments: list[tuple[int, list[float]]]  #: the next scan's new organs: x and y
    window: Window | None  #: the part of the picture that shows the plant


def picture_requests(
    clip: Clip,
    record: BakeRecord,
    organs: Sequence[ScanOrgans],
    errors: Sequence[HoldoutError],
    scale: ErrorScale | None,
) -> dict[str, PictureRequest]:
    """All pictures of the report, by name.

    Of each scan; half-way through each interval; of each scan left out the scan, its
    reconstruction and the error in colours.
    """
    palette = clip.palette[:, :3]
    requests = {
        f"scan-{k}": PictureRequest(frame.positions, palette[scan.points])
        for k, (frame, scan) in enumerate(zip(record.keyframes, organs, strict=True))
    }
    for k, interval in enumerate(clip.intervals):
        if len(clip.intervals) <= MAX_PICTURED_INTERVALS:
            frame = clip.at((interval.start + interval.end) / 2)
            requests[f"between-{k}"] = PictureRequest(frame.local, palette[frame.tracks])
    for k, (held, error) in enumerate(zip(record.held_out, errors, strict=True)):
        assert scale is not None
        points, reconstruction = held.keyframe.positions, error.reconstruction
        colors, reconstructed = held.keyframe.colors, clip.at(error.time).colors
        if colors is None or not clip.has_colors:
            colors = np.full((len(points), 3), NEUTRAL_COLOR, np.uint8)
            reconstructed = np.full((len(reconstruction), 3), NEUTRAL_COLOR, np.uint8)
        requests[f"real-{k}"] = PictureRequest(points, colors[:, :3])
        requests[f"reconstruction-{k}"] = PictureRequest(reconstruction, reconstructed[:, :3])
        requests[f"error-{k}"] = PictureRequest(reconstruction, scale.colors(error.distances))
    return requests


def interval_figures(
    clip: Clip, record: BakeRecord, organs: Sequence[ScanOrgans]
) -> list[IntervalFigure]:
    """One figure an interval."""
    figures = []
    for k in range(len(clip.intervals)):
        distances = organ_distances(record, k)
        found = reasons(clip, record, k, organs[k], distances)
        figures.append(IntervalFigure(found, merged_segments(record, k), distances))
    return figures


def scan_figures(
    record: BakeRecord,
    organs: Sequence[ScanOrgans],
    intervals: Sequence[IntervalFigure],
    pictures: Mapping[str, Picture],
) -> list[ScanFigure]:
    """One figure a scan; over its picture each segment of the graph stands where it is seen."""
    figures = []
    for k, (hierarchy, scan) in enumerate(zip(record.hierarchies, organs, strict=True)):
        points, picture = record.keyframes[k].positions, pictures.get(f"scan-{k}")
        after = intervals[k].reasons if k < len(intervals) else []
        over, window, attachments = None, None, []
        if picture is not None:
            window = picture.window(points)
            centers = picture.project(segment_centers(hierarchy, points))
            over = draw_over(centers, (window.width, window.height))
            attachments = [
                (reason.pair.track, picture.project(reason.attachment[None])[0].tolist())
                for reason in after
                if reason.attachment is not None
            ]
        figures.append(
            ScanFigure(
                organs=scan,
                absorbed=absorbed_organs(record, k) if after else {},
                tree=draw_tree(hierarchy, scan.segments),
                over=over,
                attachments=attachments,
                window=window,
            )
        )
    return figures
