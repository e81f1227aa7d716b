"""The timeline: a line with marks and dates of the scans, and a handle with the current date."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from imgui_bundle import imgui, imgui_ctx

from gclip import Clip
from player.ui.theme import Color, Pen, one_line, to_u32, with_alpha
from player.ui.widgets import EDGE, card
from player.view.annotations import MAX_NAME_LENGTH
from player.view.state import Scene
from traits.dates import date_at, elapsed, short_dates
from traits.doubts import doubts_of

DATE_SIZE, LABEL_SIZE, LEGEND_SIZE = 19.0, 15.0, 13.0  # of fonts
# Lengths in units of 1/96 inch, distances from the line downwards or upwards
HIT_DISTANCE = 18.0  # within which the mouse can drag the handle
SNAP_DISTANCE = 4.0  # between a click and a mark within which the click selects the mark's day
LABEL_DISTANCE, BUBBLE_DISTANCE = 25.0, 24.0  # of the centres of dates, and of the date's card
DOT_RADIUS, HANDLE_RADIUS = 5.0, 8.0
EVENT_DISTANCE, EVENT_SIZE = 12.0, 19.0  # of the icons of births and losses
BORN, LOST, DOUBTFUL = "\uf0d8", "\uf0d7", "\uf068"  # icons
DOUBT_DISTANCE, DOUBT_GAP = 8.0, 11.0  # of strokes at doubtful intervals, and beside their scans
HELD_OUT_HALF_LENGTH = 6.0  # of strokes at held-out scans


@dataclass(frozen=True)
class Line:
    """Maps days to positions on the timeline, in units of 1/96 inch."""

    left: float
    right: float
    height: float  #: y coordinate
    times: tuple[float, ...]  #: of the scans
    held_out: tuple[float, ...] = ()  #: times of held-out scans

    def x_of(self, day: float) -> float:
        return float(np.interp(day, self.times[:: len(self.times) - 1], (self.left, self.right)))

    def day_at(self, x: float) -> float:
        """The day at a position, which snaps to scans and held-out scans."""
        nearest = min((*self.times, *self.held_out), key=lambda time: abs(self.x_of(time) - x))
        if abs(self.x_of(nearest) - x) <= SNAP_DISTANCE:
            return nearest
        return float(np.interp(x, (self.left, self.right), self.times[:: len(self.times) - 1]))


def fitting_labels(
    line: Line, texts: Sequence[str], ends: tuple[float, float], measure: Callable[[str], float]
) -> list[tuple[int, float]]:
    """Choose dates of scans that fit below the line without overlap, first and last ones first.

    ends: the range of x coordinates for labels; measure: returns the width of a text.
    Returns pairs of a scan's index and the x coordinate of its label's centre.
    """
    kept: dict[int, tuple[float, float]] = {}
    for scan in (0, len(texts) - 1, *range(1, len(texts) - 1)):
        half = measure(texts[scan]) / 2
        x = max(min(line.x_of(line.times[scan]), ends[1] - half), ends[0] + half)
        if all(abs(x - other) >= half + width + 12.0 for other, width in kept.values()):
            kept[scan] = (x, half)
    return [(scan, x) for scan, (x, _) in sorted(kept.items())]


class TimelineView:
    """Draws the timeline of one clip; `dragging` tells whether the mouse drags the handle."""

    def __init__(self, clip: Clip) -> None:
        self._clip, self._doubts = clip, doubts_of(clip)
        # Numbers of organs by the time of the first scan with them, or without them.
        self._born = Counter(t.born for t in clip.track_table if t.born > clip.times[0])
        self._lost = Counter(t.lost for t in clip.track_table if t.lost is not None)
        self._dates = short_dates([scan.date for scan in clip.scans])
        self.dragging = False

    def draw(self, pen: Pen, scene: Scene, line: Line) -> Scene:
        """Draw in ImGui's current window, and return the scene as the mouse changed it."""
        y, mouse_x = line.height, imgui.get_mouse_pos().x
        imgui.set_cursor_screen_pos((line.left - HIT_DISTANCE / 2, y - HIT_DISTANCE))
        width = line.right - line.left + HIT_DISTANCE
        imgui.invisible_button("timeline", (width, 2 * HIT_DISTANCE))
        self.dragging, hovered = imgui.is_item_active(), imgui.is_item_hovered()
        if self.dragging or imgui.is_item_deactivated():  # the last motion counts, too
            scene = scene.with_timeline(lambda timeline: timeline.at(line.day_at(mouse_x)))
        day = scene.timeline.day
        _draw_line(pen, line, day, hovered or self.dragging)
        self._draw_marks(pen, line)
        for key, _ in scene.path.keys:
            below = line.x_of(key), y + EVENT_DISTANCE
            pen.sheet.add_ngon_filled(below, 4.5, to_u32(pen.theme.text), 4)
        edges = EDGE, pen.size[0] - EDGE
        for scan, x in fitting_labels(line, self._dates, edges, lambda t: pen.width(t, LABEL_SIZE)):
            color = pen.theme.text if line.times[scan] == day else pen.theme.muted
            pen.write(x, y + LABEL_DISTANCE, self._dates[scan], LABEL_SIZE, color, align=0.5)
        details = elapsed(self._clip.scans, day, self._clip.time_unit)
        if hovered and not self.dragging and abs(mouse_x - line.x_of(day)) > HANDLE_RADIUS:
            day = line.day_at(mouse_x)  # what a click would go to
            details = self._description_of(day)
            disc = DOT_RADIUS + SNAP_DISTANCE, with_alpha(pen.theme.accent, 0.35)
            _draw_discs(pen, line.x_of(day), y, disc)
        _draw_bubble(pen, line, day, date_at(self._clip.scans, day), details)
        return scene

    def draw_legend(self, pen: Pen, left: float, y: float) -> None:
        """Draw a legend of the marks that occur, as far as there is room."""
        theme, x = pen.theme, left
        for occurs, icon, color, text in (
            (self._born, BORN, theme.accent, "born"),
            (self._lost, LOST, theme.loss, "lost"),
            (self._doubts, DOUBTFUL, theme.loss, "in doubt"),
        ):
            end = x + 14.0 + pen.width(text, LEGEND_SIZE)
            if occurs and end <= pen.size[0] - EDGE:
                pen.write(x + 4.0, y, icon, EVENT_SIZE, color, align=0.5)
                pen.write(x + 14.0, y, text, LEGEND_SIZE, theme.muted)
                x = end + 12.0

    def _draw_marks(self, pen: Pen, line: Line) -> None:
        """Draw marks of births above the line and of losses below it, strokes across the line at
        held-out scans, and strokes along the line at doubtful intervals.
        """
        theme, y = pen.theme, line.height
        for doubt in self._doubts:
            x, end = line.x_of(doubt.start) + DOUBT_GAP, line.x_of(doubt.end) - DOUBT_GAP
            corners = (x, y + DOUBT_DISTANCE), (max(end, x + 2.0), y + DOUBT_DISTANCE + 3.0)
            pen.sheet.add_rect_filled(*corners, to_u32(theme.loss), 1.5)
        for x in map(line.x_of, line.held_out):
            ends = (x, y - HELD_OUT_HALF_LENGTH), (x, y + HELD_OUT_HALF_LENGTH)
            pen.sheet.add_line(*ends, to_u32(theme.muted), 2.0)
        for day in line.times:
            if self._born[day]:
                above = y - EVENT_DISTANCE
                pen.write(line.x_of(day), above, BORN, EVENT_SIZE, theme.accent, align=0.5)
            if self._lost[day]:
                below = y + EVENT_DISTANCE
                pen.write(line.x_of(day), below, LOST, EVENT_SIZE, theme.loss, align=0.5)

    def _description_of(self, day: float) -> str:
        """Describe the scan of a day, or doubts about an interval; "" if there is neither."""
        facts = [f"{scan.points:,} points" for scan in self._clip.scans if scan.time == day]
        if facts:
            counts = (self._born[day], "born"), (self._lost[day], "lost")
            return ", ".join(facts + [f"{count} {what}" for count, what in counts if count])
        doubts = [doubt.what for doubt in self._doubts if doubt.start < day < doubt.end]
        return f"looks wrong: {', '.join(dict.fromkeys(doubts))}" if doubts else ""


def _draw_line(pen: Pen, line: Line, day: float, highlighted: bool) -> None:
    theme, y, thickness = pen.theme, line.height, 2.5 if highlighted else 1.5
    now = line.x_of(day)
    for right, color in ((line.right, theme.track), (now, theme.accent)):
        corners = (line.left, y - thickness), (right, y + thickness)
        pen.sheet.add_rect_filled(*corners, to_u32(color), thickness)
    for time in line.times:
        discs = [(DOT_RADIUS + 2.0, theme.veil), (DOT_RADIUS, theme.accent)]
        if time > day:
            discs = [discs[0], (DOT_RADIUS, theme.muted), (DOT_RADIUS - 2.0, theme.veil)]
        _draw_discs(pen, line.x_of(time), y, *discs)
    radius = HANDLE_RADIUS + (2.0 if highlighted else 0.0)
    handle = (radius + 2.5, theme.veil), (radius, theme.accent), (HANDLE_RADIUS - 4.0, theme.veil)
    _draw_discs(pen, now, y, *handle)


def _draw_bubble(pen: Pen, line: Line, day: float, date: str, details: str) -> None:
    """Draw a card with the date and details above the position of a day."""
    x, bottom = line.x_of(day), line.height - BUBBLE_DISTANCE
    corners = (x - 6.0, bottom), (x + 6.0, bottom), (x, bottom + 6.0)
    pen.sheet.add_triangle_filled(*corners, to_u32(pen.theme.card))
    with card("bubble", (x, bottom), (0.5, 1.0), pen.size[0]):
        with imgui_ctx.push_font(pen.bold, DATE_SIZE):
            imgui.text_unformatted(one_line(date, MAX_NAME_LENGTH))
        if details:
            imgui.same_line()
            imgui.set_cursor_pos_y(imgui.get_cursor_pos_y() + 4.0)  # align with the date's baseline
            imgui.text_disabled(one_line(details, 2 * MAX_NAME_LENGTH))


def _draw_discs(pen: Pen, x: float, y: float, *discs: tuple[float, Color]) -> None:
    """Draw concentric discs of some radii and colours."""
    for radius, color in discs:
        pen.sheet.add_circle_filled((x, y), radius, to_u32(color), 48)
