"""`play CLIP --info`: what a clip holds, as tables for a terminal or a pipe."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gclip.errors import ClipError
from gclip.text import printable

if TYPE_CHECKING:
    from rich.console import Console

    from gclip import Clip, HeldOutScan, ScanMark

MAX_ROWS = 1000  # of a table: more scroll past, and take minutes to lay out
MAX_LENGTH = 2000  # characters of one line of provenance
FOR_PROGRAMS = {"transforms", "origins"}  # matrices of provenance
SCANS = ("scan", "date", "", "points")
INTERVALS = ("from", "to", "born", "lost", "degree", "positions", "B a mover", "movers")
TRACKS = ("track", "kind", "grows from", "color", "born", "lost")

Row = Sequence[str]


def print_info(console: Console, clip: Clip, path: Path) -> None:
    """Print a clip's scans, intervals, tracks and provenance."""
    try:
        size = path.stat().st_size
    except OSError as error:
        raise ClipError(f"{path}: it can't be read any more: {error.strerror or error}.") from None
    from rich.filesize import decimal

    movers = sum(map(len, clip.intervals))
    first, last = clip.scans[0], clip.scans[-1]
    extent = " × ".join(f"{high - low:.4g}" for low, high in zip(*clip.bounds, strict=True))
    colors = "of the scans" if clip.has_colors else "of the tracks"
    for line in (
        f"{path.name}: {decimal(size)}, {movers:,} movers, {size / movers:.1f} B a mover",
        f"{first.date} to {last.date}, {last.time - first.time:g} {clip.time_unit}",
        f"extent {extent} {clip.unit or 'units'}, up {clip.up}, point spacing {clip.spacing:.3g}, "
        f"colours {colors}",
    ):
        _say(console, line)
    scans = [column or clip.time_unit for column in SCANS]
    _table(console, "Scans", scans, [_scan(s, first.time, s.points) for s in clip.scans])
    if clip.held_out:
        held = [_scan(s, first.time, len(s.positions)) for s in clip.held_out]
        _table(console, "Scans left out, to compare with", scans, held)
    _table(console, "Intervals", INTERVALS, _intervals(clip))
    _table(console, "Tracks", TRACKS, _tracks(clip))
    for key, value in sorted(clip.provenance.items()):
        if key == "verdict" and isinstance(value, dict):
            value = value.get("line", value)
        if key not in FOR_PROGRAMS:
            _provenance(console, key, value)


def _scan(scan: ScanMark | HeldOutScan, first: float, points: int) -> Row:
    return scan.name, scan.date, f"{scan.time - first:g}", f"{points:,}"


def _intervals(clip: Clip) -> Iterator[Row]:
    for interval in clip.intervals:
        buffers = [*interval.curve, interval.tracks]
        buffers += [c for c in (interval.start_colors, interval.end_colors) if c is not None]
        events = [segment.event for segment in interval.segments]
        yield (
            _date(clip, interval.start),
            _date(clip, interval.end),
            str(events.count("birth")) if events else "–",
            str(events.count("loss")) if events else "–",
            str(interval.degree),
            "float32" if interval.box is None else "16 bit",
            str(sum(buffer.itemsize * (buffer.size // len(buffer)) for buffer in buffers)),
            f"{len(interval):,}",
        )


def _tracks(clip: Clip) -> Iterator[Row]:
    for track in clip.track_table:
        yield (
            track.name,
            track.kind,
            "" if track.parent is None else clip.track_table[track.parent].name,
            "#{:02x}{:02x}{:02x}".format(*track.color),
            _date(clip, track.born),
            "" if track.lost is None else _date(clip, track.lost),
        )


def _date(clip: Clip, time: float) -> str:
    return next((scan.date for scan in clip.scans if scan.time == time), "") or f"{time:g}"


def _provenance(console: Console, key: str, value: Any) -> None:
    items = value if isinstance(value, list) else []
    _say(console, f"{key}:" if items else f"{key}: {_short(value)}")
    for item in items[:MAX_ROWS]:
        _say(console, f"  {_short(item)}")
    if len(items) > MAX_ROWS:
        _say(console, f"and {len(items) - MAX_ROWS:,} more")


def _short(value: Any) -> str:
    if isinstance(value, dict):
        said = ((name, own) for name, own in value.items() if own not in (None, "", [], {}))
        return ", ".join(f"{name} {_short(own)}" for name, own in said)
    if isinstance(value, list):
        return "; ".join(map(_short, value))
    return value if isinstance(value, str) else json.dumps(value)


def _table(console: Console, title: str, columns: Row, rows: Iterable[Row]) -> None:
    """Columns of numbers are set to the right. Cells are text, never markup."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    rows = iter(rows)
    shown = list(islice(rows, MAX_ROWS))
    table = Table(box=box.SIMPLE_HEAD, title=title, title_justify="left", pad_edge=False)
    for number, column in enumerate(columns):
        cells = (row[number].replace(",", "").replace(".", "") for row in shown)
        numbers = all(cell.isdigit() for cell in cells)
        table.add_column(column, justify="right" if numbers else "left", no_wrap=True)
    for row in shown:
        table.add_row(*(Text(printable(cell)) for cell in row))
    console.print(table)
    rest = sum(1 for _ in rows)
    if rest:
        _say(console, f"and {rest:,} more")


def _say(console: Console, line: str) -> None:
    """Names come from a file: control characters in them must not reach the terminal."""
    console.print(printable(line, MAX_LENGTH), markup=False, highlight=False, soft_wrap=True)
