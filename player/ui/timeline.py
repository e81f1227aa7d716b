"""Draws the timeline: its line, the scans' marks and dates, the handle with the current date."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from player.ui.canvas import BOLD, Canvas, Color
from player.ui.layout import LABEL_SIZE, SNAP, Layout
from player.view.dates import date_at, elapsed
from traits.doubts import doubts_of

if TYPE_CHECKING:
    from gclip import Clip
    from player.ui.theme import Theme
    from player.view.playback import Timeline

DATE_SIZE, SIDE_SIZE = 19.0, 15.0
LABELS_BELOW = 25.0  # from the line to the middle of the dates under it
BUBBLE_ABOVE, BUBBLE_HEIGHT, PADDING, SPACE = 40.0, 32.0, 12.0, 9.0
DOT, HANDLE = 5.0, 8.0
EVENT = 13.0  # from the line to the marks of births and losses
DOUBT, DOUBT_GAP = 8.0, 11.0  # from the line to the stroke of a doubtful interval, and to its scans
LEFT_OUT = 6.0  # half of the stroke where a scan was left out
BRACKET = 9.0  # half the height of the brackets about the part that is played


def draw_timeline(
    canvas: Canvas,
    theme: Theme,
    layout: Layout,
    clip: Clip,
    timeline: Timeline,
    pointed: float | None,
    lively: bool,
    keys: Sequence[float] = (),
) -> None:
    """pointed: x of the cursor where it rests on the timeline; lively: the line is in use.
    keys: days of the camera's path.
    """
    _draw_line(canvas, theme, layout, timeline, lively)
    _draw_events(canvas, theme, layout, clip)
    for day in keys:
        _diamond(canvas, layout.x_of(day), layout.line + EVENT, theme.text)
    _draw_dates(canvas, theme, layout, timeline)
    if pointed is not None and abs(pointed - layout.x_of(timeline.day)) > HANDLE:
        _draw_preview(canvas, theme, layout, clip, pointed)
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
    begin, end = layout.x_of(timeline.lower), layout.x_of(timeline.upper)
    canvas.rectangle(begin, top, max(now - begin, 0.0), thickness, theme.accent, 2.5)
    _draw_range(canvas, theme, line, timeline, (begin, end))
    for time in layout.times:
        x, passed = layout.x_of(time), time <= timeline.day
        canvas.disc(x, line, DOT + 2.0, theme.veil)
        canvas.disc(x, line, DOT, theme.accent if passed else theme.muted)
        if not passed:
            canvas.disc(x, line, DOT - 2.0, theme.veil)
    canvas.disc(now, line, HANDLE + (2.0 if lively else 0.0) + 2.5, theme.veil)
    canvas.disc(now, line, HANDLE + (2.0 if lively else 0.0), theme.accent)
    canvas.disc(now, line, HANDLE - 4.0, theme.on_accent)


def _draw_range(
    canvas: Canvas, theme: Theme, line: float, timeline: Timeline, ends: tuple[float, float]
) -> None:
    """Brackets about the part that is played."""
    if timeline.begin is None and timeline.end is None:
        return
    for x, inwards in zip(ends, (1.0, -1.0), strict=True):
        canvas.line((x, line - BRACKET), (x, line + BRACKET), theme.text, 2.0)
        for y in (line - BRACKET, line + BRACKET):
            canvas.line((x, y), (x + 5.0 * inwards, y), theme.text, 2.0)


def _draw_events(canvas: Canvas, theme: Theme, layout: Layout, clip: Clip) -> None:
    """Births above the line, losses below it, at the scans that first show them; strokes across it
    where scans were left out, and along it where the bake doubts an interval.
    """
    for doubt in doubts_of(clip):
        x, end = layout.x_of(doubt.start) + DOUBT_GAP, layout.x_of(doubt.end) - DOUBT_GAP
        canvas.rectangle(x, layout.line + DOUBT, max(end - x, 2.0), 3.0, theme.loss, 1.5)
    for held in clip.held_out:
        x = layout.x_of(held.time)
        canvas.line((x, layout.line - LEFT_OUT), (x, layout.line + LEFT_OUT), theme.muted, 2.0)
    for scan, (born, lost) in zip(clip.scans, events(clip), strict=True):
        x = layout.x_of(scan.time)
        for count, side, paint in ((born, -1.0, theme.accent), (lost, 1.0, theme.loss)):
            if count:
                base = layout.line + side * (EVENT - 3.0)
                tip = base + side * 6.0
                canvas.triangle([(x - 4.0, base), (x + 4.0, base), (x, tip)], paint)


def events(clip: Clip) -> list[tuple[int, int]]:
    """For each scan how many organs it shows for the first time, and how many no longer."""
    return [
        (
            sum(t.born == scan.time and i > 0 for t in clip.track_table),
            sum(t.lost == scan.time for t in clip.track_table),
        )
        for i, scan in enumerate(clip.scans)
    ]


def _diamond(canvas: Canvas, x: float, y: float, paint: Color) -> None:
    for side in (-1.0, 1.0):
        canvas.triangle([(x - 4.5, y), (x + 4.5, y), (x, y + 4.5 * side)], paint)


def _draw_dates(canvas: Canvas, theme: Theme, layout: Layout, timeline: Timeline) -> None:
    for label in layout.labels:
        here = layout.times[label.scan] == timeline.day
        color = theme.text if here else theme.muted
        canvas.text(label.x, layout.line + LABELS_BELOW, label.text, LABEL_SIZE, color, align=0.5)


def _draw_preview(canvas: Canvas, theme: Theme, layout: Layout, clip: Clip, pointed: float) -> None:
    """What a click would go to."""
    day = layout.day_at(pointed)
    x = layout.x_of(day)
    canvas.disc(x, layout.line, DOT + SNAP, (*theme.accent[:3], 0.35))
    wrong = [doubt.what for doubt in doubts_of(clip) if doubt.start < day < doubt.end]
    side = f"looks wrong: {', '.join(dict.fromkeys(wrong))}" if wrong else ""
    for scan, (born, lost) in zip(clip.scans, events(clip), strict=True):
        if scan.time == day:
            side = f"{scan.points:,} points"
            side += f", {born} born" if born else ""
            side += f", {lost} lost" if lost else ""
    _draw_bubble(canvas, theme, layout, day, date_at(clip.scans, day), side, strong=False)


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
