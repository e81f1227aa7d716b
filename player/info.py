"""`play CLIP --info`: what a clip holds, as tables for a terminal or a pipe."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from gclip.errors import ClipError
from gclip.terminal.text import printable

if TYPE_CHECKING:
    from rich.console import Console

    from gclip import Clip, Interval, Track

T = TypeVar("T")
MOST_ROWS = 1000  # of a table: more scroll past, and take minutes to lay out
LONGEST = 2000  # characters of one line of provenance


def print_info(console: Console, clip: Clip, path: Path) -> None:
    """Print a clip's scans, intervals, tracks and provenance."""
    size, dates = _size(path), {scan.time: scan.date for scan in clip.scans}
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
        clip.scans,
        lambda s: (s.name, s.date, f"{s.time - first.time:g}", f"{s.points:,}"),
        numbers=2,
    )
    if clip.held_out:
        _table(
            console,
            "Scans left out, to compare with",
            ("scan", "date", clip.time_unit, "points"),
            clip.held_out,
            lambda s: (s.name, s.date, f"{s.time - first.time:g}", f"{len(s.positions):,}"),
            numbers=2,
        )
    _table(
        console,
        "Intervals",
        ("from", "to", "born", "lost", "degree", "positions", "B a mover", "movers"),
        clip.intervals,
        lambda interval: _interval_row(interval, dates),
        numbers=6,
    )
    _table(
        console,
        "Tracks",
        ("track", "kind", "grows from", "color", "born", "lost"),
        clip.track_table,
        lambda track: _track_row(track, clip, dates),
        numbers=2,
    )
    for key, value in sorted(clip.provenance.items()):
        _provenance(console, key, value)


def _size(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError as error:
        raise ClipError(f"{path}: it can't be read any more: {error.strerror or error}.") from None


def _interval_row(interval: Interval, dates: dict[float, str]) -> tuple[str, ...]:
    buffers = [*interval.curve, interval.tracks]
    buffers += [c for c in (interval.start_colors, interval.end_colors) if c is not None]
    events = [segment.event for segment in interval.segments]
    return (
        _date(interval.start, dates),
        _date(interval.end, dates),
        str(events.count("birth")) if events else "–",
        str(events.count("loss")) if events else "–",
        str(interval.degree),
        "float32" if interval.box is None else "16 bit",
        str(sum(buffer.itemsize * (buffer.size // len(buffer)) for buffer in buffers)),
        f"{len(interval):,}",
    )


def _track_row(track: Track, clip: Clip, dates: dict[float, str]) -> tuple[str, ...]:
    parent = "" if track.parent is None else clip.track_table[track.parent].name
    red, green, blue = track.color
    return (
        track.name,
        track.kind,
        parent,
        f"#{red:02x}{green:02x}{blue:02x}",
        _date(track.born, dates),
        "" if track.lost is None else _date(track.lost, dates),
    )


def _date(time: float, dates: dict[float, str]) -> str:
    return dates.get(time) or f"{time:g}"


def _provenance(console: Console, key: str, value: Any) -> None:
    if isinstance(value, list) and value:
        _say(console, f"{key}:")
        for item in value[:MOST_ROWS]:
            _say(console, f"  {_short(item)}")
        _rest(console, len(value))
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
    entries: Sequence[T],
    row: Callable[[T], Sequence[str]],
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
    for entry in entries[:MOST_ROWS]:
        table.add_row(*(Text(printable(cell)) for cell in row(entry)))
    console.print(table)
    _rest(console, len(entries))


def _rest(console: Console, count: int) -> None:
    if count > MOST_ROWS:
        _say(console, f"and {count - MOST_ROWS:,} more")


def _say(console: Console, line: str) -> None:
    """Names come from a file: control characters in them must not reach the terminal."""
    console.print(printable(line, LONGEST), markup=False, highlight=False, soft_wrap=True)
