"""What the report shows of scans, intervals and scans left out, pictures included."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.pipeline import BakeRecord
from baker.report.errormap import Bar, Scale, histogram
from baker.report.graph import Graph, draw_over, draw_tree, middles
from baker.report.merges import Joined, absorbed, joined
from baker.report.organs import ScanOrgans
from baker.report.pictures import PIXELS, Picture, Plate, Window, take_pictures
from baker.report.reasons import Nearness, Reason, nearness, reasons
from baker.report.verification import HoldoutError
from gclip import Clip, ScanMark

PLAIN = (122, 146, 110)  # scans without colours of their own, where organs don't matter
FEW = 12  # intervals up to which the state half-way through each is pictured too
MANY = 24  # pictures from which on they are smaller


@dataclass(frozen=True)
class Bud:
    """Where in a scan's picture, in pixels, the next scan's new organ unfolds from."""

    organ: int
    x: float
    y: float


@dataclass(frozen=True)
class ScanFigure:
    """One scan: its hierarchy as a graph, alone and over the plant's picture where there is one.

    notes:     what segmenting it found.
    buds:      of the organs that the next scan has more.
    born, lost: organs that this scan is the first to hold, or the first to lack.
    absorbed:   organs that are part of another one from this scan on, and of which.
    window:     the part of the picture that shows the plant.
    """

    number: int
    mark: ScanMark
    notes: tuple[str, ...]
    segments: int
    organs: ScanOrgans
    born: tuple[int, ...]
    lost: tuple[int, ...]
    absorbed: dict[int, int]
    tree: Graph
    over: Graph | None = None
    buds: tuple[Bud, ...] = ()
    picture: Picture | None = None
    window: Window | None = None

    @property
    def merging(self) -> bool:
        """Whether several of the scan's segments are one organ."""
        return len(set(self.organs.segments)) < self.segments


@dataclass(frozen=True)
class IntervalFigure:
    """One interval: each segment's way through it, and why it was this one."""

    number: int
    start: ScanMark
    end: ScanMark
    movers: int
    reasons: tuple[Reason, ...]
    merges: tuple[Joined, ...]
    near: Nearness | None
    picture: Picture | None = None

    def organs(self, event: str) -> tuple[int, ...]:
        """The organs that something happens to: "match", "birth" or "loss"."""
        return tuple(r.pair.track for r in self.reasons if r.pair.event == event)

    @property
    def solvers(self) -> dict[str, int]:
        """How many segment pairs each solver solved."""
        names = [reason.pair.solver for reason in self.reasons if reason.pair.event != "loss"]
        return {name: names.count(name) for name in sorted(set(names))}

    @property
    def cost(self) -> float:
        """Root mean square of the matched pairs' costs, weighed by their movers."""
        pairs = [r.pair for r in self.reasons if r.pair.event == "match" and r.pair.movers]
        weights = [pair.movers for pair in pairs] or [1]
        return float(np.average([p.cost**2 for p in pairs] or [0.0], weights=weights) ** 0.5)

    @property
    def marginal_error(self) -> float:
        """The worst of all segment pairs."""
        return max((reason.pair.marginal_error for reason in self.reasons), default=0.0)


@dataclass(frozen=True)
class HoldoutFigure:
    """One scan left out (Figure 13): real, rebuilt, and the error in colours; pictures or none."""

    error: HoldoutError
    bars: tuple[Bar, ...]
    real: Picture | None = None
    rebuilt: Picture | None = None
    map: Picture | None = None
    window: Window | None = None


@dataclass(frozen=True)
class Pictures:
    """All pictures of a report, each None or missing where the player could not draw."""

    scans: tuple[Picture | None, ...]
    intervals: tuple[Picture | None, ...]
    holdouts: tuple[tuple[Picture, Picture, Picture] | tuple[None, None, None], ...]

    @classmethod
    def none(cls, scans: int, holdouts: int) -> Pictures:
        return cls((None,) * scans, (None,) * (scans - 1), ((None, None, None),) * holdouts)


def take_all(
    clip: Clip,
    record: BakeRecord,
    organs: Sequence[ScanOrgans],
    errors: Sequence[HoldoutError],
    scale: Scale | None,
    workers: int,
    tell: Callable[[int, int], None],
    folder: Path | None = None,
) -> Pictures:
    """All pictures from one camera. Raises NoPicture where the player can't draw.

    folder: for temporary files; None leaves that to the system.
    """
    palette = clip.palette[:, :3]
    plates = [
        Plate(frame.positions, palette[scan.points])
        for frame, scan in zip(record.keyframes, organs, strict=True)
    ]
    between = clip.intervals if len(clip.intervals) <= FEW else ()
    for interval in between:
        frame = clip.at((interval.start + interval.end) / 2)
        plates.append(Plate(frame.local, palette[frame.tracks]))
    for held, error in zip(record.held_out, errors, strict=True):
        assert scale is not None
        real, rebuilt = held.keyframe.colors, clip.at(error.time)
        own = clip.has_colors and real is not None
        points = held.keyframe.positions
        plates += [
            Plate(points, real[:, :3] if own and real is not None else _plain(points)),
            Plate(error.rebuilt, rebuilt.colors[:, :3] if own else _plain(error.rebuilt)),
            Plate(error.rebuilt, scale.colors(error.distances)),
        ]
    tell(0, len(plates))
    taken = take_pictures(
        plates,
        clip,
        workers,
        lambda done: tell(done, len(plates)),
        PIXELS if len(plates) < MANY else PIXELS // 2,
        folder,
    )
    scans, halfway = len(organs), len(between)
    rest = taken[scans + halfway :]
    return Pictures(
        scans=tuple(taken[:scans]),
        intervals=tuple(taken[scans : scans + halfway]) or (None,) * len(clip.intervals),
        holdouts=tuple((rest[i], rest[i + 1], rest[i + 2]) for i in range(0, len(rest), 3)),
    )


def _plain(points: NDArray[np.floating]) -> NDArray[np.uint8]:
    return np.tile(np.array(PLAIN, np.uint8), (len(points), 1))


def scan_figures(
    clip: Clip,
    record: BakeRecord,
    organs: Sequence[ScanOrgans],
    intervals: Sequence[IntervalFigure],
    pictures: Pictures,
) -> list[ScanFigure]:
    """One figure a scan; the graph lies over the picture where each segment's middle is."""
    figures, last = [], len(organs) - 1
    for k, (hierarchy, scan, picture) in enumerate(
        zip(record.hierarchies, organs, pictures.scans, strict=True)
    ):
        points = record.keyframes[k].positions
        events = intervals[k - 1] if k else None
        over, window, buds = None, None, []
        if picture is not None:
            born = [r for r in intervals[k].reasons if r.bud is not None] if k < last else []
            spots = picture.place(np.array([r.bud for r in born]).reshape(-1, 3))
            buds = [Bud(r.pair.track, *map(float, xy)) for r, xy in zip(born, spots, strict=True)]
            window = picture.window(points)
            places = picture.place(middles(hierarchy, points))
            over = draw_over(hierarchy, scan.segments, places, (window.width, window.height))
        figures.append(
            ScanFigure(
                number=k,
                mark=clip.scans[k],
                notes=hierarchy.notes,
                segments=len(hierarchy.segments),
                organs=scan,
                born=events.organs("birth") if events else (),
                lost=events.organs("loss") if events else (),
                absorbed=absorbed(record, k) if k < last else {},
                tree=draw_tree(hierarchy, scan.segments),
                over=over,
                buds=tuple(buds),
                picture=picture,
                window=window,
            )
        )
    return figures


def interval_figures(
    clip: Clip, record: BakeRecord, organs: Sequence[ScanOrgans], pictures: Pictures
) -> list[IntervalFigure]:
    """One figure an interval."""
    figures = []
    for k, picture in enumerate(pictures.intervals):
        near = nearness(record, k)
        figures.append(
            IntervalFigure(
                number=k,
                start=clip.scans[k],
                end=clip.scans[k + 1],
                movers=len(clip.intervals[k]),
                reasons=tuple(reasons(clip, record, k, organs[k], near)),
                merges=tuple(joined(record, k)),
                near=near,
                picture=picture,
            )
        )
    return figures


def holdout_figures(
    record: BakeRecord, errors: Sequence[HoldoutError], scale: Scale | None, pictures: Pictures
) -> list[HoldoutFigure]:
    """One figure a scan left out; its pictures show the same part of the scene."""
    figures = []
    for held, error, taken in zip(record.held_out, errors, pictures.holdouts, strict=True):
        assert scale is not None
        real, rebuilt, colored = taken
        window = None
        if real is not None:
            window = real.window(np.concatenate([held.keyframe.positions, error.rebuilt]))
        bars = tuple(histogram(error, scale))
        figures.append(HoldoutFigure(error, bars, real, rebuilt, colored, window))
    return figures
