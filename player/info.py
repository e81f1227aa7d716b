"""`play CLIP --info`: what a clip holds, as tables for a terminal or a pipe."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console

    from gclip import Clip, Interval, Track


def print_info(console: Console, clip: Clip, path: Path) -> None:
    """Print a clip's scans, intervals, tracks and provenance."""
    size = path.stat().st_size
    movers = sum(len(interval) for interval in clip.intervals)
    first, last = clip.scans[0], clip.scans[-1]
    low, high = clip.bounds
    _say(console, f"{path.name}: {_bytes(size)}, {movers:,} movers, {size / movers:.1f} B a mover")
    _say(console, f"{first.date} to {last.date}, {last.time - first.time:g} {clip.time_unit}")
    extent = " × ".join(f"{side:.4g}" for side in high - low)
    _say(
        console,
        f"extent {extent} {clip.unit or 'units'}, up {clip.up}, "
        f"point spacing {clip.spacing:.3g}, colours "
        f"{'of the scans' if clip.has_colors else 'of the tracks'}",
    )
    _table(
        console,
        "Scans",
        ("scan", "date", clip.time_unit, "points"),
        [(s.name, s.date, f"{s.time - first.time:g}", f"{s.points:,}") for s in clip.scans],
        numbers=2,
    )
    _table(
        console,
        "Intervals",
        ("from", "to", "born", "lost", "degree", "positions", "B a mover", "movers"),
        [_interval_row(interval, clip) for interval in clip.intervals],
        numbers=6,
    )
    _table(
        console,
        "Tracks",
        ("track", "kind", "grows from", "color", "born", "lost"),
        [_track_row(track, clip) for track in clip.track_table],
        numbers=2,
    )
    for key, value in sorted(clip.provenance.items()):
        _provenance(console, key, value)


def _interval_row(interval: Interval, clip: Clip) -> tuple[str, ...]:
    buffers = [*interval.curve, interval.tracks]
    buffers += [c for c in (interval.start_colors, interval.end_colors) if c is not None]
    events = [segment.event for segment in interval.segments]
    return (
        _date(interval.start, clip),
        _date(interval.end, clip),
        str(events.count("birth")) if events else "–",
        str(events.count("loss")) if events else "–",
        str(interval.degree),
        "float32" if interval.box is None else "16 bit",
        str(sum(buffer.itemsize * (buffer.size // len(buffer)) for buffer in buffers)),
        f"{len(interval):,}",
    )


def _track_row(track: Track, clip: Clip) -> tuple[str, ...]:
    parent = "" if track.parent is None else clip.track_table[track.parent].name
    red, green, blue = track.color
    return (
        track.name,
        track.kind,
        parent,
        f"#{red:02x}{green:02x}{blue:02x}",
        _date(track.born, clip),
        "" if track.lost is None else _date(track.lost, clip),
    )


def _date(time: float, clip: Clip) -> str:
    dates = {scan.time: scan.date for scan in clip.scans}
    return dates.get(time) or f"{time:g}"


def _provenance(console: Console, key: str, value: Any) -> None:
    if isinstance(value, list) and value:
        _say(console, f"{key}:")
        for item in value:
            _say(console, f"  {_short(item)}")
    else:
        _say(console, f"{key}: {_short(value)}")


def _short(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def _bytes(count: int) -> str:
    return f"{count / 1e6:.1f} MB" if count >= 1e6 else f"{count / 1e3:.1f} kB"


def _table(
    console: Console,
    title: str,
    columns: Sequence[str],
    rows: Sequence[Sequence[str]],
    numbers: int,
) -> None:
    """A table whose last `numbers` columns are set to the right. Cells are text, never markup."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, title=title, title_justify="left", pad_edge=False)
    for index, column in enumerate(columns):
        right = index >= len(columns) - numbers
        table.add_column(column, justify="right" if right else "left", no_wrap=True)
    for row in rows:
        table.add_row(*(Text(_printable(cell)) for cell in row))
    console.print(table)


def _say(console: Console, line: str) -> None:
    console.print(_printable(line), markup=False, highlight=False, soft_wrap=True)


def _printable(text: str) -> str:
    """Names come from a file: control characters in them must not reach the terminal."""
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text)
