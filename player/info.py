"""`play CLIP --info`: what a clip holds, line by line."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gclip import Clip, HeldOutScan, Interval, ScanMark, Track

FOR_PROGRAMS = {"transforms", "origins"}  # matrices of provenance
INTERVALS = ("from", "to", "born", "lost", "degree", "positions", "movers")
TRACKS = ("track", "kind", "grows from", "color", "born", "lost")

Row = Sequence[str]


def info_lines(clip: Clip, path: Path) -> Iterator[str]:
    """A clip's scans, intervals, tracks and provenance, as text for a terminal or a pipe.

    Names come from a file: what is printed of them must be made safe (`gclip.text.printable`).
    """
    size, movers = path.stat().st_size, sum(map(len, clip.intervals))
    first, last = clip.scans[0], clip.scans[-1]
    extent = " × ".join(f"{high - low:.4g}" for low, high in zip(*clip.bounds, strict=True))
    colors = "of the scans" if clip.has_colors else "of the tracks"
    yield f"{path.name}: {size / 1e6:,.1f} MB, {movers:,} movers, {size / movers:.1f} B a mover"
    yield f"{first.date} to {last.date}, {last.time - first.time:g} {clip.time_unit}"
    yield (
        f"extent {extent} {clip.unit or 'units'}, up {clip.up}, point spacing {clip.spacing:.3g}, "
        f"colours {colors}"
    )
    scans = ("scan", "date", clip.time_unit, "points")
    yield from _table("Scans", scans, *(_scan(s, first.time, s.points) for s in clip.scans))
    if clip.held_out:
        held = (_scan(s, first.time, len(s.positions)) for s in clip.held_out)
        yield from _table("Scans left out, to compare with", scans, *held)
    yield from _table("Intervals", INTERVALS, *(_interval(clip, one) for one in clip.intervals))
    yield from _table("Tracks", TRACKS, *(_track(clip, one) for one in clip.track_table))
    yield ""
    for key, value in sorted(clip.provenance.items()):
        if key == "verdict" and isinstance(value, dict):
            value = value.get("line", value)
        if isinstance(value, list) and key not in FOR_PROGRAMS:
            yield f"{key}:"
            yield from (f"  {_short(item)}" for item in value)
        elif key not in FOR_PROGRAMS:
            yield f"{key}: {_short(value)}"


def _scan(scan: ScanMark | HeldOutScan, first: float, points: int) -> Row:
    return scan.name, scan.date, f"{scan.time - first:g}", f"{points:,}"


def _interval(clip: Clip, interval: Interval) -> Row:
    events = [segment.event for segment in interval.segments]
    return (
        _date(clip, interval.start),
        _date(clip, interval.end),
        str(events.count("birth")) if events else "–",
        str(events.count("loss")) if events else "–",
        str(interval.degree),
        "float32" if interval.box is None else "16 bit",
        f"{len(interval):,}",
    )


def _track(clip: Clip, track: Track) -> Row:
    return (
        track.name,
        track.kind,
        "" if track.parent is None else clip.track_table[track.parent].name,
        "#{:02x}{:02x}{:02x}".format(*track.color),
        _date(clip, track.born),
        "" if track.lost is None else _date(clip, track.lost),
    )


def _date(clip: Clip, time: float) -> str:
    return next((scan.date for scan in clip.scans if scan.time == time), "") or f"{time:g}"


def _short(value: Any) -> str:
    if isinstance(value, dict):
        said = ((name, own) for name, own in value.items() if own not in (None, "", [], {}))
        return ", ".join(f"{name} {_short(own)}" for name, own in said)
    if isinstance(value, list):
        return "; ".join(map(_short, value))
    return value if isinstance(value, str) else json.dumps(value)


def _table(title: str, *rows: Row) -> Iterator[str]:
    """A title and columns of text."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    yield from ("", title)
    for row in rows:
        cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        yield "  ".join(cells).rstrip()
