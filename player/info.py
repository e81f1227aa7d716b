"""`play CLIP --info`: what a clip holds, line by line."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gclip import Clip

FOR_PROGRAMS = {"transforms", "origins"}  # matrices of provenance


def info_lines(clip: Clip, path: Path) -> Iterator[str]:
    """A clip's scans, intervals, tracks and provenance, as text for a terminal or a pipe.

    Names come from a file: what is printed of them must be made safe (`gclip.text.printable`).
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
    for scan, points, note in sorted(scans, key=lambda one: one[0].time):
        rows.append((scan.name, scan.date, f"{scan.time - first.time:g}", f"{points:,}", note))
    yield from _table(rows)

    rows = [("from", "to", "born", "lost", "degree", "positions", "movers")]
    for one in clip.intervals:
        events = [segment.event for segment in one.segments]
        counts = (str(events.count(event)) if events else "–" for event in ("birth", "loss"))
        kind = str(one.degree), "float32" if one.box is None else "16 bit", f"{len(one):,}"
        rows.append((_date(clip, one.start), _date(clip, one.end), *counts, *kind))
    yield from _table(rows)

    rows = [("track", "kind", "grows from", "color", "born", "lost")]
    for track in tracks:
        parent = "" if track.parent is None else tracks[track.parent].name
        color = "#{:02x}{:02x}{:02x}".format(*track.color)
        life = (_date(clip, track.born), "" if track.lost is None else _date(clip, track.lost))
        rows.append((track.name, track.kind, parent, color, *life))
    yield from _table(rows)

    yield ""
    for key, value in sorted(clip.provenance.items()):
        if key == "verdict" and isinstance(value, dict):
            value = value.get("line", value)
        if isinstance(value, list) and key not in FOR_PROGRAMS:
            yield f"{key}:"
            yield from (f"  {_short(item)}" for item in value)
        elif key not in FOR_PROGRAMS:
            yield f"{key}: {_short(value)}"


def _date(clip: Clip, time: float) -> str:
    return next((scan.date for scan in clip.scans if scan.time == time), "") or f"{time:g}"


def _short(value: Any) -> str:
    if isinstance(value, dict):
        said = ((name, own) for name, own in value.items() if own not in (None, "", [], {}))
        return ", ".join(f"{name} {_short(own)}" for name, own in said)
    if isinstance(value, list):
        return "; ".join(map(_short, value))
    return value if isinstance(value, str) else json.dumps(value)


def _table(rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """Columns of text, the first row their titles."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    yield ""
    for row in rows:
        yield "  ".join(cell.ljust(n) for cell, n in zip(row, widths, strict=True)).rstrip()
