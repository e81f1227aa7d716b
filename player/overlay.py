"""Draws what lies over the plant: title, buttons, timeline, passing notices and the help."""

from __future__ import annotations

from typing import TYPE_CHECKING

from player import keys
from player.canvas import BOLD, ICONS, Canvas
from player.dates import short_dates
from player.help_card import draw_help
from player.layout import BAR, TIMELINE, TOP, Layout, Rectangle, arrange
from player.theme import DARK, LIGHT, Theme
from player.timeline import AtEnd
from player.timeline_view import draw_timeline

if TYPE_CHECKING:
    import moderngl

    from gclip import Clip
    from player.scene import Scene

TITLE_SIZE, TEXT_SIZE, ICON_SIZE, PLAY_ICON_SIZE = 20.0, 15.0, 15.0, 17.0

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
    "help": "\uf128",
}
AT_END_ICON = {AtEnd.LOOP: "\uf363", AtEnd.PING_PONG: "\uf07e", AtEnd.STOP: "\uf061"}
DOTS = {"smaller": 2.5, "larger": 6.0}  # radius of the dot that stands for a point size
SPEED_TEXT = {0.125: "⅛×", 0.25: "¼×", 0.5: "½×"}


class Overlay:
    """Belongs to one clip in one window.

    name: what the user calls the clip, for the title.
    """

    def __init__(self, context: moderngl.Context, clip: Clip, name: str) -> None:
        self._canvas = Canvas(context)
        self._clip = clip
        self._name = name
        self._layout: Layout | None = None

    def draw(
        self,
        framebuffer: moderngl.Framebuffer,
        scene: Scene,
        size: tuple[float, float],
        scale: float,
        cursor: tuple[float, float] | None = None,
        held: str | None = None,
    ) -> Layout:
        """Draw over `framebuffer`, and tell where things stand.

        size:   of the window in units; scale: pixels in a unit.
        cursor: where the mouse is, in units; None while it is elsewhere.
        held:   what a mouse button went down on and still holds: TIMELINE or a button's name.
        """
        canvas, theme = self._canvas, LIGHT if scene.style.ground == "light" else DARK
        canvas.begin(size, scale)
        layout = self._layout = self._arranged(size)
        over = None
        if cursor and not scene.help:
            over = held or layout.under(*cursor)
        clear, dense = (*theme.veil[:3], 0.0), (*theme.veil[:3], 0.85)
        canvas.gradient(0.0, size[1] - BAR, size[0], BAR, clear, dense)
        canvas.gradient(0.0, 0.0, size[0], TOP, (*theme.veil[:3], 0.6), clear)
        self._draw_title(layout, theme)
        for name, place in layout.buttons.items():
            self._draw_button(name, place, scene, theme, over == name)
        if layout.speed:
            text = SPEED_TEXT.get(scene.timeline.speed, f"{scene.timeline.speed:.0f}×")
            canvas.text(*layout.speed, text, TEXT_SIZE + 2.0, theme.text, BOLD, align=0.5)
        pointed = cursor[0] if cursor and over == TIMELINE and not held else None
        lively = over == TIMELINE
        draw_timeline(canvas, theme, layout, self._clip, scene.timeline, pointed, lively)
        if over and over != TIMELINE:
            self._draw_tip(layout, theme, over)
        if scene.notice:
            self._draw_card(scene.notice, size[0] / 2, layout.margin + 64.0, theme, size[0])
        if scene.help:
            draw_help(canvas, theme, size)
        canvas.finish(framebuffer)
        return layout

    def release(self) -> None:
        self._canvas.release()

    def _arranged(self, size: tuple[float, float]) -> Layout:
        if self._layout is not None and self._layout.size == size:
            return self._layout
        dates = [scan.date for scan in self._clip.scans]
        return arrange(size, self._clip.times, dates, short_dates(dates), self._canvas.width)

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
        color = theme.accent if name == "turn" and scene.turning else theme.text
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
        """A line of text on a card about (x, y), kept inside the window."""
        canvas = self._canvas
        text = canvas.fitted(text, TEXT_SIZE, width - 40.0)
        wide = canvas.width(text, TEXT_SIZE) + 20.0
        left = min(max(x - wide / 2, 8.0), width - 8.0 - wide)
        canvas.rectangle(left, y - 13.0, wide, 26.0, theme.card, 7.0)
        canvas.frame(left, y - 13.0, wide, 26.0, theme.edge, 7.0)
        canvas.text(left + 10.0, y, text, TEXT_SIZE, theme.text)


def _icon(name: str, scene: Scene) -> str:
    if name == "at end":
        return AT_END_ICON[scene.timeline.at_end]
    if name == "ground":
        return "\uf185" if scene.style.ground == "dark" else "\uf186"
    if name == "fullscreen":
        return "\uf066" if scene.fullscreen else "\uf065"
    return ICON[name]
