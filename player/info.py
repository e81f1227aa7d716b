"""Summary of a clip as text, for `play CLIP --info`."""

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gclip import Clip

UNLISTED_KEYS = {"transforms", "origins"}  # of the provenance: matrices


def info_lines(clip: "Clip", path: Path) -> Iterator[str]:
    """Yield lines on a clip's scans, intervals, tracks and provenance.

    The lines contain names from the file, and must be made safe for terminals by
    `gclip.text.printable`.
    """
    size, movers = path.stat().st_size, sum(map(len, clip.intervals))
    first, last, tracks = clip.scans[0], clip.scans[-1], clip.track_table
    extent = " × ".join(f"{high - low:.4g}" for low, high in zip(*clip.bounds, strict=True))
    colors = "of the scans" if clip.has_colors else "of the tracks"
    yield f"{path.name}: {size / 1e6:,.1f} MB, {movers:,} movers, {size / movers:.1f} B a mover"
    yield f"{first.date} to {last.date}, {last.time - first.time:g} {clip.time_unit}"
    yield (
        f"extent {extent} {clip.unit or 'units'}, up {clip.up}, point spacing {clip.spacing:.3g}, "
        f"colours {colors}"
    )
    scans: list[Any] = [(scan, scan.points, "") for scan in clip.scans]
    scans += [(scan, len(scan.positions), "left out") for scan in clip.held_out]
    rows: list[Sequence[str]] = [("scan", "date", clip.time_unit, "points", "")]
    for scan, points, note in sorted(scans, key=lambda entry: entry[0].time):
        rows.append((scan.name, scan.date, f"{scan.time - first.time:g}", f"{points:,}", note))
    yield from _table(rows)

    rows = [("from", "to", "born", "lost", "degree", "positions", "movers")]
    for interval in clip.intervals:
        events = [segment.event for segment in interval.segments]
        counts = (str(events.count(event)) if events else "–" for event in ("birth", "loss"))
        storage = "float32" if interval.box is None else "16 bit"
        details = str(interval.degree), storage, f"{len(interval):,}"
        ends = _format_date(clip, interval.start), _format_date(clip, interval.end)
        rows.append((*ends, *counts, *details))
    yield from _table(rows)

    rows = [("track", "kind", "grows from", "color", "born", "lost")]
    for track in tracks:
        parent = "" if track.parent is None else tracks[track.parent].name
        color = "#{:02x}{:02x}{:02x}".format(*track.color)
        lost = "" if track.lost is None else _format_date(clip, track.lost)
        born = _format_date(clip, track.born)
        rows.append((track.name, track.kind, parent, color, born, lost))
    yield from _table(rows)

    yield ""
    for key, value in sorted(clip.provenance.items()):
        if key == "verdict" and isinstance(value, dict):
            value = value.get("line", value)
        if isinstance(value, list) and key not in UNLISTED_KEYS:
            yield f"{key}:"
            yield from (f"  {_format_value(item)}" for item in value)
        elif key not in UNLISTED_KEYS:
            yield f"{key}: {_format_value(value)}"


def _format_date(clip: "Clip", time: float) -> str:
    """The date of the scan at a time, or else the time as a number."""
    return next((scan.date for scan in clip.scans if scan.time == time), "") or f"{time:g}"


def _format_value(value: Any) -> str:
    if isinstance(value, dict):
        filled = ((key, item) for key, item in value.items() if item not in (None, "", [], {}))
        return ", ".join(f"{key} {_format_value(item)}" for key, item in filled)
    if isinstance(value, list):
        return "; ".join(map(_format_value, value))
    return value if isinstance(value, str) else json.dumps(value)


def _table(rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """Yield an empty line, and rows of cells as aligned columns."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    yield ""
    for row in rows:
        yield "  ".join(cell.ljust(n) for cell, n in zip(row, widths, strict=True)).rstrip()
