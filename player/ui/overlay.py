"""Draws what lies over the plant: title, buttons, timeline, guides, notices, panel and help."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from player.ui import keys
from player.ui.annotations import (
    draw_axes,
    draw_legend,
    draw_organ,
    draw_panes,
    draw_progress,
    draw_scale_bar,
    has_room,
)
from player.ui.canvas import BOLD, ICONS, Canvas, Pointer
from player.ui.help import draw_help
from player.ui.layout import (
    BAR,
    PANEL,
    TIMELINE,
    TOP,
    WIPE,
    Layout,
    Rectangle,
    arrange,
    panel_place,
    panel_width,
)
from player.ui.panel import Exporting, Panel
from player.ui.theme import DARK, LIGHT, Theme
from player.ui.timeline import draw_timeline
from player.view.choices import Compare
from player.view.dates import date_at, short_dates
from player.view.playback import AtEnd

if TYPE_CHECKING:
    from collections.abc import Sequence

    import moderngl

    from gclip import Clip
    from player.view.colors import ValueRange
    from player.view.split_view import Pane
    from player.view.state import Scene

TITLE_SIZE, TEXT_SIZE, ICON_SIZE, PLAY_ICON_SIZE = 20.0, 15.0, 15.0, 17.0
LINE = 20.0  # of texts of several lines

# Font Awesome 6, by the name of the action that the button does.
ICON = {
    "previous": "\uf048",
    "next": "\uf051",
    "slower": "\uf068",
    "faster": "\uf067",
    "color": "\uf53f",
    "turn": "\uf2f9",
    "fit": "\uf05b",
    "picture": "\uf030",
    "panel": "\uf1de",
    "help": "\uf128",
}
AT_END_ICON = {AtEnd.LOOP: "\uf363", AtEnd.PING_PONG: "\uf07e", AtEnd.STOP: "\uf061"}
DOTS = {"smaller": 2.5, "larger": 6.0}  # radius of the dot that stands for a point size
SPEED_TEXT = {0.125: "⅛×", 0.25: "¼×", 0.5: "½×"}


@dataclass(frozen=True)
class Facts:
    """What is to be told beside the scene itself.

    scale:     what the colours stand for.
    organ:     of the picked one, (what, value) pairs.
    panes:     what is compared, from left to right.
    exporting: an export under way.
    """

    scale: ValueRange | None = None
    organ: tuple[tuple[str, str], ...] = ()
    panes: Sequence[Pane] = ()
    exporting: Exporting | None = None


class Overlay:
    """Belongs to one clip in one window.

    name:   what the user calls the clip, for the title.
    chosen: the scene as the user changed it with the panel in the last picture.
    popup:  whether the panel has something open that takes the mouse wherever it is.
    """

    def __init__(self, context: moderngl.Context, clip: Clip, name: str) -> None:
        self._canvas = Canvas(context)
        self._panel = Panel(self._canvas, clip)
        self._clip = clip
        self._name = name
        self._layout: Layout | None = None
        self.chosen: Scene | None = None
        self.popup = False

    def draw(
        self,
        framebuffer: moderngl.Framebuffer,
        scene: Scene,
        size: tuple[float, float],
        scale: float,
        cursor: tuple[float, float] | None = None,
        held: str | None = None,
        facts: Facts | None = None,
        wheel: float = 0.0,
    ) -> Layout:
        """Draw over `framebuffer`, and tell where things stand.

        size:   of the window in units; scale: pixels in a unit.
        cursor: where the mouse is, in units; None while it is elsewhere.
        held:   what a mouse button went down on and still holds: TIMELINE, PANEL or a button's
                name.
        wheel:  notches that it was turned over the panel.
        """
        canvas, theme = self._canvas, LIGHT if scene.style.ground == "light" else DARK
        facts = facts or Facts()
        free = held in (None, PANEL) and not scene.help
        canvas.begin(size, scale, Pointer(cursor if free else None, held == PANEL, wheel))
        aside = panel_width(size[0], scene.panel and not scene.kiosk)
        wipe = scene.wipe if scene.compare is Compare.WIPE else None
        panel = panel_place(size) if scene.panel and not scene.kiosk else None
        layout = replace(self._arranged((size[0] - aside, size[1]), wipe), panel=panel)
        self.chosen = scene
        if scene.kiosk:
            self._draw_kiosk(layout, theme, scene)
        else:
            over = None
            if cursor and not scene.help and held != PANEL:
                over = held or layout.under(*cursor)
            self._draw_chrome(layout, theme, scene, cursor, held, over)
            self._draw_guides(layout, theme, scene, facts)
            if panel:
                place = (panel.x, panel.y, panel.width, panel.height)
                self.chosen = self._panel.draw(scene, theme, place, facts.exporting)
            if over not in (None, TIMELINE, PANEL, WIPE):
                self._draw_tip(layout, theme, str(over))
        self.popup = canvas.popup
        canvas.to_front()
        if scene.notice:
            self._draw_card(scene.notice, layout.size[0] / 2, TOP + 2.0, theme, layout.size[0])
        if scene.help:
            draw_help(canvas, theme, size)
        canvas.finish(framebuffer)
        return layout

    def release(self) -> None:
        self._canvas.release()

    def _arranged(self, size: tuple[float, float], wipe: float | None) -> Layout:
        line = None if wipe is None else wipe * size[0]
        if self._layout is None or self._layout.size != size:
            dates = [scan.date for scan in self._clip.scans]
            times, short = self._clip.times, short_dates(dates)
            strokes = tuple(scan.time for scan in self._clip.held_out)
            arranged = arrange(size, times, dates, short, self._canvas.width)
            self._layout = replace(arranged, strokes=strokes)
        if self._layout.wipe != line:
            self._layout = replace(self._layout, wipe=line)
        return self._layout

    def _draw_chrome(
        self,
        layout: Layout,
        theme: Theme,
        scene: Scene,
        cursor: tuple[float, float] | None,
        held: str | None,
        over: str | None,
    ) -> None:
        canvas, (width, height) = self._canvas, layout.size
        clear, dense = (*theme.veil[:3], 0.0), (*theme.veil[:3], 0.85)
        canvas.gradient(0.0, height - BAR, width, BAR, clear, dense)
        canvas.gradient(0.0, 0.0, width, TOP, (*theme.veil[:3], 0.6), clear)
        self._draw_title(layout, theme)
        for name, place in layout.buttons.items():
            self._draw_button(name, place, scene, theme, over == name)
        if layout.speed:
            text = SPEED_TEXT.get(scene.timeline.speed, f"{scene.timeline.speed:.0f}×")
            canvas.text(*layout.speed, text, TEXT_SIZE + 2.0, theme.text, BOLD, align=0.5)
        pointed = cursor[0] if cursor and over == TIMELINE and not held else None
        days = [day for day, _ in scene.path.keys]
        lively = over == TIMELINE
        draw_timeline(canvas, theme, layout, self._clip, scene.timeline, pointed, lively, days)

    def _draw_guides(self, layout: Layout, theme: Theme, scene: Scene, facts: Facts) -> None:
        canvas, clip = self._canvas, self._clip
        if facts.panes:
            draw_panes(canvas, theme, layout, facts.panes)
        if has_room(layout.size):
            if scene.guides:
                above = 42.0 if facts.panes else 0.0
                draw_scale_bar(canvas, theme, layout, scene.camera, clip.unit, above)
                draw_axes(canvas, theme, layout, scene.camera)
            if scene.legend:
                organs = scene.color_mode == "track" and not scene.panel
                draw_legend(canvas, theme, layout, clip, facts.scale, organs)
        picked = scene.style.picked
        if picked is not None and layout.size[1] >= 320.0:
            track = clip.track_table[picked]
            red, green, blue = (channel / 255.0 for channel in track.color)
            paint = (red, green, blue, 1.0)
            draw_organ(canvas, theme, layout, track.name, paint, facts.organ)
        if facts.exporting is not None:
            one = facts.exporting
            draw_progress(canvas, theme, layout, one.name, one.done, one.total)

    def _draw_kiosk(self, layout: Layout, theme: Theme, scene: Scene) -> None:
        """The date, and nothing that could be pressed."""
        canvas, x, y = self._canvas, layout.margin + 8.0, layout.size[1] - layout.margin - 16.0
        date = date_at(self._clip.scans, scene.timeline.day)
        canvas.text(x, y, date, 26.0, theme.text, BOLD)
        canvas.text(x, y - 32.0, self._name, 17.0, theme.muted)

    def _draw_title(self, layout: Layout, theme: Theme) -> None:
        canvas, x, y = self._canvas, layout.margin, layout.margin
        room = layout.buttons["color"].x - x - 12.0
        name = canvas.fitted(self._name, TITLE_SIZE, room, BOLD)
        canvas.text(x, y + 9.0, name, TITLE_SIZE, theme.text, BOLD)
        scans, tracks = len(self._clip.scans), len(self._clip.track_table)
        facts = canvas.fitted(f"{scans} scans, {tracks} organs", TEXT_SIZE, room)
        canvas.text(x, y + 31.0, facts, TEXT_SIZE, theme.muted)

    def _draw_button(
        self, name: str, place: Rectangle, scene: Scene, theme: Theme, pointed: bool
    ) -> None:
        canvas, (x, y) = self._canvas, place.middle
        if name == "play":
            canvas.disc(x, y, place.width / 2 + (1.5 if pointed else 0.0), theme.accent)
            icon, nudge = ("\uf04c", 0.0) if scene.timeline.playing else ("\uf04b", 1.5)
            canvas.text(x + nudge, y, icon, PLAY_ICON_SIZE, theme.on_accent, ICONS, align=0.5)
            return
        if pointed:
            canvas.rectangle(place.x, place.y, place.width, place.height, theme.hover, 8.0)
        on = (name == "turn" and scene.turning) or (name == "panel" and scene.panel)
        color = theme.accent if on else theme.text
        if name in DOTS:
            canvas.disc(x, y, DOTS[name], color)
        else:
            canvas.text(x, y, _icon(name, scene), ICON_SIZE, color, ICONS, align=0.5)

    def _draw_tip(self, layout: Layout, theme: Theme, name: str) -> None:
        """What the button under the cursor does, and the key that does it too."""
        action, place = keys.action(name), layout.buttons[name]
        above = place.y > layout.size[1] / 2
        y = place.y - 22.0 if above else place.y + place.height + 20.0
        text = f"{action.help}  ({action.labels[0]})"
        self._draw_card(text, place.middle[0], y, theme, layout.size[0])

    def _draw_card(self, text: str, x: float, y: float, theme: Theme, width: float) -> None:
        """Text on a card about x, kept inside the window, its first line at y."""
        canvas = self._canvas
        lines = canvas.wrapped(text, TEXT_SIZE, width - 40.0)
        wide = max(canvas.width(line, TEXT_SIZE) for line in lines) + 20.0
        high = 26.0 + LINE * (len(lines) - 1)
        left = min(max(x - wide / 2, 8.0), width - 8.0 - wide)
        canvas.rectangle(left, y - 13.0, wide, high, theme.card, 7.0)
        canvas.frame(left, y - 13.0, wide, high, theme.edge, 7.0)
        for number, line in enumerate(lines):
            canvas.text(left + 10.0, y + LINE * number, line, TEXT_SIZE, theme.text)


def _icon(name: str, scene: Scene) -> str:
    if name == "at end":
        return AT_END_ICON[scene.timeline.at_end]
    if name == "ground":
        return "\uf185" if scene.style.ground == "dark" else "\uf186"
    if name == "fullscreen":
        return "\uf066" if scene.fullscreen else "\uf065"
    return ICON[name]
