"""Draws the timeline: its line, the scans' marks and dates, the handle with the current date."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from player.canvas import BOLD, Canvas
from player.dates import date_at, elapsed
from player.layout import LABEL_SIZE, SNAP, Layout

if TYPE_CHECKING:
    from gclip import Clip, ScanMark
    from player.theme import Theme
    from player.timeline import Timeline

DATE_SIZE, SIDE_SIZE = 19.0, 15.0
LABELS_BELOW = 25.0  # from the line to the middle of the dates under it
BUBBLE_ABOVE, BUBBLE_HEIGHT, PADDING, SPACE = 40.0, 32.0, 12.0, 9.0
DOT, HANDLE = 5.0, 8.0


def draw_timeline(
    canvas: Canvas,
    theme: Theme,
    layout: Layout,
    clip: Clip,
    timeline: Timeline,
    pointed: float | None,
    lively: bool,
) -> None:
    """pointed: x of the cursor where it rests on the timeline; lively: the line is in use."""
    _draw_line(canvas, theme, layout, timeline, lively)
    _draw_dates(canvas, theme, layout, timeline)
    if pointed is not None and abs(pointed - layout.x_of(timeline.day)) > HANDLE:
        _draw_preview(canvas, theme, layout, clip.scans, pointed)
        return
    _draw_bubble(
        canvas,
        theme,
        layout,
        timeline.day,
        date_at(clip.scans, timeline.day),
        elapsed(clip.scans, timeline.day, clip.time_unit),
        strong=True,
    )


def _draw_line(
    canvas: Canvas, theme: Theme, layout: Layout, timeline: Timeline, lively: bool
) -> None:
    line, now = layout.line, layout.x_of(timeline.day)
    thickness = 5.0 if lively else 3.0
    top = line - thickness / 2
    canvas.rectangle(layout.left, top, layout.right - layout.left, thickness, theme.track, 2.5)
    canvas.rectangle(layout.left, top, now - layout.left, thickness, theme.accent, 2.5)
    for time in layout.times:
        x, passed = layout.x_of(time), time <= timeline.day
        canvas.disc(x, line, DOT + 2.0, theme.veil)
        canvas.disc(x, line, DOT, theme.accent if passed else theme.muted)
        if not passed:
            canvas.disc(x, line, DOT - 2.0, theme.veil)
    canvas.disc(now, line, HANDLE + (2.0 if lively else 0.0) + 2.5, theme.veil)
    canvas.disc(now, line, HANDLE + (2.0 if lively else 0.0), theme.accent)
    canvas.disc(now, line, HANDLE - 4.0, theme.on_accent)


def _draw_dates(canvas: Canvas, theme: Theme, layout: Layout, timeline: Timeline) -> None:
    for label in layout.labels:
        here = layout.times[label.scan] == timeline.day
        color = theme.text if here else theme.muted
        canvas.text(label.x, layout.line + LABELS_BELOW, label.text, LABEL_SIZE, color, align=0.5)


def _draw_preview(
    canvas: Canvas, theme: Theme, layout: Layout, scans: Sequence[ScanMark], pointed: float
) -> None:
    """What a click would go to."""
    day = layout.day_at(pointed)
    x = layout.x_of(day)
    canvas.disc(x, layout.line, DOT + SNAP, (*theme.accent[:3], 0.35))
    there = [scan for scan in scans if scan.time == day]
    side = f"{there[0].points:,} points" if there else ""
    _draw_bubble(canvas, theme, layout, day, date_at(scans, day), side, strong=False)


def _draw_bubble(
    canvas: Canvas, theme: Theme, layout: Layout, day: float, date: str, side: str, strong: bool
) -> None:
    room = layout.size[0] - 2 * PADDING - 16.0
    date = canvas.fitted(date, DATE_SIZE, room, BOLD)
    date_width = canvas.width(date, DATE_SIZE, BOLD)
    side = canvas.fitted(side, SIDE_SIZE, max(room - date_width - SPACE, 0.0))
    side_width = canvas.width(side, SIDE_SIZE) + SPACE if side else 0.0
    width = date_width + side_width + 2 * PADDING
    tip = layout.x_of(day)
    x = min(max(tip - width / 2, 8.0), layout.size[0] - 8.0 - width)
    y = layout.line - BUBBLE_ABOVE
    top, bottom = y - BUBBLE_HEIGHT / 2, y + BUBBLE_HEIGHT / 2
    canvas.rectangle(x, top, width, BUBBLE_HEIGHT, theme.card, 8.0)
    canvas.frame(x, top, width, BUBBLE_HEIGHT, theme.accent if strong else theme.edge, 8.0)
    canvas.triangle(
        [(tip - 6.0, bottom), (tip + 6.0, bottom), (tip, bottom + 6.0)],
        theme.accent if strong else theme.card,
    )
    canvas.text(x + PADDING, y, date, DATE_SIZE, theme.text, BOLD)
    canvas.text(x + PADDING + date_width + SPACE, y + 0.5, side, SIDE_SIZE, theme.muted)
