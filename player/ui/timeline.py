"""The timeline: its line, the scans' marks and dates, the handle with the current date."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from imgui_bundle import imgui, imgui_ctx

from gclip import Clip
from player.ui.theme import Color, Pen, faint, one_line, packed
from player.ui.widgets import EDGE, card
from player.view.annotations import MAX_NAME
from player.view.dates import date_at, elapsed, short_dates
from player.view.state import Scene
from traits.doubts import doubts_of

DATE_SIZE, LABEL_SIZE, KEY_SIZE = 19.0, 15.0, 13.0
REACH = 18.0  # how far from the line the mouse still takes hold of it
SNAP = 4.0  # how near to a scan's mark a click means the scan itself
LABELS_BELOW = 25.0  # from the line to the middle of the dates under it
BUBBLE_ABOVE = 24.0  # from the line to the lower edge of the date's card
DOT, HANDLE = 5.0, 8.0
EVENT, MARK = 12.0, 19.0  # from the line to the marks of births and losses; their size
BORN, LOST, DOUBTFUL = "\uf0d8", "\uf0d7", "\uf068"  # icons
DOUBT, DOUBT_GAP = 8.0, 11.0  # from the line to the stroke of a doubtful interval, and to its scans
LEFT_OUT = 6.0  # half of the stroke where a scan was left out


@dataclass(frozen=True)
class Line:
    """Where the days stand."""

    left: float  #: its ends, and its height, in units
    right: float
    height: float
    times: tuple[float, ...]  #: of the scans
    others: tuple[float, ...] = ()  #: more days that a click means exactly

    def x_of(self, day: float) -> float:
        return float(np.interp(day, self.times[:: len(self.times) - 1], (self.left, self.right)))

    def day_at(self, x: float) -> float:
        """The day at a place; right at one of `times` and `others`, that day."""
        nearest = min((*self.times, *self.others), key=lambda time: abs(self.x_of(time) - x))
        if abs(self.x_of(nearest) - x) <= SNAP:
            return nearest
        return float(np.interp(x, (self.left, self.right), self.times[:: len(self.times) - 1]))


def labels_on(
    line: Line, texts: Sequence[str], ends: tuple[float, float], measure: Callable[[str], float]
) -> list[tuple[int, float]]:
    """Which of the scans' dates fit under the line, and about which x.

    ends: between which they stay. Those of the first and the last scan go before the others.
    """
    kept: dict[int, tuple[float, float]] = {}
    for scan in (0, len(texts) - 1, *range(1, len(texts) - 1)):
        half = measure(texts[scan]) / 2
        x = max(min(line.x_of(line.times[scan]), ends[1] - half), ends[0] + half)
        if all(abs(x - other) >= half + width + 12.0 for other, width in kept.values()):
            kept[scan] = (x, half)
    return [(scan, x) for scan, (x, _) in sorted(kept.items())]


class TimelineView:
    """Of one clip. held: whether the mouse drags its handle."""

    def __init__(self, clip: Clip) -> None:
        self._clip, self._doubts = clip, doubts_of(clip)
        # How many organs the scan of a day shows for the first time, and how many no longer.
        self._born = Counter(one.born for one in clip.track_table if one.born > clip.times[0])
        self._lost = Counter(one.lost for one in clip.track_table if one.lost is not None)
        self._dates = short_dates([scan.date for scan in clip.scans])
        self.held = False

    def draw(self, pen: Pen, scene: Scene, line: Line) -> Scene:
        """Draw it on the window that ImGui has begun; gives the scene as the mouse changed it."""
        y, pointed = line.height, imgui.get_mouse_pos().x
        imgui.set_cursor_screen_pos((line.left - REACH / 2, y - REACH))
        imgui.invisible_button("timeline", (line.right - line.left + REACH, 2 * REACH))
        self.held, hovered = imgui.is_item_active(), imgui.is_item_hovered()
        if self.held or imgui.is_item_deactivated():  # it may be let go where it has just come to
            scene = scene.with_timeline(lambda timeline: timeline.at(line.day_at(pointed)))
        day = scene.timeline.day
        _draw_line(pen, line, day, hovered or self.held)
        self._draw_marks(pen, line)
        for key, _ in scene.path.keys:
            pen.sheet.add_ngon_filled((line.x_of(key), y + EVENT), 4.5, packed(pen.theme.text), 4)
        edges = EDGE, pen.size[0] - EDGE
        for scan, x in labels_on(line, self._dates, edges, lambda t: pen.width(t, LABEL_SIZE)):
            color = pen.theme.text if line.times[scan] == day else pen.theme.muted
            pen.write(x, y + LABELS_BELOW, self._dates[scan], LABEL_SIZE, color, align=0.5)
        side = elapsed(self._clip.scans, day, self._clip.time_unit)
        if hovered and not self.held and abs(pointed - line.x_of(day)) > HANDLE:
            day = line.day_at(pointed)  # what a click would go to
            side = self._told_of(day)
            _rings(pen, line.x_of(day), y, (DOT + SNAP, faint(pen.theme.accent, 0.35)))
        _draw_bubble(pen, line, day, date_at(self._clip.scans, day), side)
        return scene

    def draw_key(self, pen: Pen, left: float, y: float) -> None:
        """What the marks mean, those that occur, as far as there is room."""
        theme, x = pen.theme, left
        for occurs, icon, paint, text in (
            (self._born, BORN, theme.accent, "born"),
            (self._lost, LOST, theme.loss, "lost"),
            (self._doubts, DOUBTFUL, theme.loss, "in doubt"),
        ):
            end = x + 14.0 + pen.width(text, KEY_SIZE)
            if occurs and end <= pen.size[0] - EDGE:
                pen.write(x + 4.0, y, icon, MARK, paint, align=0.5)
                pen.write(x + 14.0, y, text, KEY_SIZE, theme.muted)
                x = end + 12.0

    def _draw_marks(self, pen: Pen, line: Line) -> None:
        """Births above the line, losses below it, at the scans that first show them; strokes across
        it where scans were left out, and along it where the bake doubts an interval.
        """
        theme, y = pen.theme, line.height
        for doubt in self._doubts:
            x, end = line.x_of(doubt.start) + DOUBT_GAP, line.x_of(doubt.end) - DOUBT_GAP
            corners = (x, y + DOUBT), (max(end, x + 2.0), y + DOUBT + 3.0)
            pen.sheet.add_rect_filled(*corners, packed(theme.loss), 1.5)
        for x in map(line.x_of, line.others):
            pen.sheet.add_line((x, y - LEFT_OUT), (x, y + LEFT_OUT), packed(theme.muted), 2.0)
        for day in line.times:
            if self._born[day]:
                pen.write(line.x_of(day), y - EVENT, BORN, MARK, theme.accent, align=0.5)
            if self._lost[day]:
                pen.write(line.x_of(day), y + EVENT, LOST, MARK, theme.loss, align=0.5)

    def _told_of(self, day: float) -> str:
        """What is to be told of a scan, or of what looks wrong on a day between two."""
        told = [f"{scan.points:,} points" for scan in self._clip.scans if scan.time == day]
        if told:
            counts = (self._born[day], "born"), (self._lost[day], "lost")
            return ", ".join(told + [f"{count} {what}" for count, what in counts if count])
        wrong = [doubt.what for doubt in self._doubts if doubt.start < day < doubt.end]
        return f"looks wrong: {', '.join(dict.fromkeys(wrong))}" if wrong else ""


def _draw_line(pen: Pen, line: Line, day: float, lively: bool) -> None:
    theme, y, thick = pen.theme, line.height, 2.5 if lively else 1.5
    now = line.x_of(day)
    for right, paint in ((line.right, theme.track), (now, theme.accent)):
        corners = (line.left, y - thick), (right, y + thick)
        pen.sheet.add_rect_filled(*corners, packed(paint), thick)
    for time in line.times:
        discs = [(DOT + 2.0, theme.veil), (DOT, theme.accent)]
        if time > day:
            discs = [discs[0], (DOT, theme.muted), (DOT - 2.0, theme.veil)]
        _rings(pen, line.x_of(time), y, *discs)
    radius = HANDLE + (2.0 if lively else 0.0)
    handle = (radius + 2.5, theme.veil), (radius, theme.accent), (HANDLE - 4.0, theme.veil)
    _rings(pen, now, y, *handle)


def _draw_bubble(pen: Pen, line: Line, day: float, date: str, side: str) -> None:
    """The date over a day, and beside it what else is to be told."""
    x, bottom = line.x_of(day), line.height - BUBBLE_ABOVE
    corners = (x - 6.0, bottom), (x + 6.0, bottom), (x, bottom + 6.0)
    pen.sheet.add_triangle_filled(*corners, packed(pen.theme.card))
    with card("bubble", (x, bottom), (0.5, 1.0), pen.size[0]):
        with imgui_ctx.push_font(pen.bold, DATE_SIZE):
            imgui.text_unformatted(one_line(date, MAX_NAME))
        if side:
            imgui.same_line()
            imgui.set_cursor_pos_y(imgui.get_cursor_pos_y() + 4.0)  # on the date's line
            imgui.text_disabled(one_line(side, 2 * MAX_NAME))


def _rings(pen: Pen, x: float, y: float, *discs: tuple[float, Color]) -> None:
    """Discs over each other, of radii and colours."""
    for radius, color in discs:
        pen.sheet.add_circle_filled((x, y), radius, packed(color), 48)
