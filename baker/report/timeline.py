"""All organs through time: one line an organ, from birth to loss."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from baker.report.organs import ScanOrgans
from gclip import Clip

LEFT, RIGHT, TOP, WIDTH = 132.0, 34.0, 34.0, 920.0
ROW, THIN_ROW, READABLE = 24.0, 7.0, 60
CLOSEST = 46.0  # pixels between two dates that are both written


@dataclass(frozen=True)
class Mark:
    """An organ in a scan: a dot whose area says how many points it has."""

    x: float
    radius: float
    points: int
    scan: int


@dataclass(frozen=True)
class Line:
    """One organ: its marks, and whether it unfolds before the first or goes after the last.

    before, after: x of the scans between which it is born or lost, None where it isn't.
    """

    organ: int
    y: float
    marks: tuple[Mark, ...]
    before: float | None
    after: float | None


@dataclass(frozen=True)
class Timeline:
    """The drawing, in pixels; `dates` are x, text and whether there is room to write it."""

    lines: tuple[Line, ...]
    dates: tuple[tuple[float, str, bool], ...]
    size: tuple[float, float]
    left: float
    top: float
    readable: bool


def draw_timeline(clip: Clip, scans: Sequence[ScanOrgans]) -> Timeline:
    """Time to the right, organs downwards by their tracks' numbers."""
    first, last = clip.times[0], clip.times[-1]
    across = [
        round(LEFT + (WIDTH - LEFT - RIGHT) * (t - first) / (last - first), 1) for t in clip.times
    ]
    tracks = [track.id for track in clip.track_table]
    readable = len(tracks) <= READABLE
    row = ROW if readable else THIN_ROW
    most = max((n for scan in scans for n in scan.counts.values()), default=1) or 1
    lines = []
    for number, organ in enumerate(tracks):
        held = [k for k, scan in enumerate(scans) if organ in scan.counts]
        if not held:
            continue
        marks = tuple(_mark(scans[k].counts[organ], most, row, across[k], k) for k in held)
        lines.append(
            Line(
                organ=organ,
                y=TOP + row * (number + 0.5),
                marks=marks,
                before=across[held[0] - 1] if held[0] > 0 else None,
                after=across[held[-1] + 1] if held[-1] + 1 < len(scans) else None,
            )
        )
    height = TOP + row * len(tracks) + 10.0
    return Timeline(tuple(lines), _dates(clip, across), (WIDTH, height), LEFT, TOP, readable)


def _mark(points: int, most: int, row: float, x: float, scan: int) -> Mark:
    radius = max(0.12, 0.46 * (points / most) ** 0.5) * row
    return Mark(x, round(radius, 1), points, scan)


def _dates(clip: Clip, across: Sequence[float]) -> tuple[tuple[float, str, bool], ...]:
    dates: list[tuple[float, str, bool]] = []
    written = -CLOSEST
    for x, scan in zip(across, clip.scans, strict=True):
        fits = x - written >= max(CLOSEST, 7.0 * len(scan.date))
        written = x if fits else written
        dates.append((x, scan.date, fits))
    return tuple(dates)
