"""What lies over the plant: title, buttons, timeline, annotations, notices, panel and help."""

from collections.abc import Sequence
from dataclasses import dataclass

import moderngl
from imgui_bundle import imgui

from gclip import Clip
from player.ui import actions
from player.ui.annotations import draw_captions, draw_guides, draw_organ, draw_progress
from player.ui.curves import draw_curve, strip_height
from player.ui.gui import Gui
from player.ui.help import draw_help
from player.ui.mouse import PlantMouse
from player.ui.panel import draw_panel, panel_place, panel_width
from player.ui.pen import Pen
from player.ui.theme import CLEAR, faint, packed, theme_of
from player.ui.timeline import TimelineView
from player.ui.widgets import bare_window, button, icon_button
from player.view.choices import Compare
from player.view.colors import ValueRange
from player.view.dates import date_at
from player.view.playback import AtEnd
from player.view.split_view import Pane
from player.view.state import Exporting, Scene
from traits.curves import TraitCurve

TOP, BOTTOM = 80.0, 124.0  # heights of the strips that hold title and buttons, and the timeline
CAPTION = 36.0  # of the one that tells what is compared
CONTROLS = 84.0  # height of what the mouse can hold in the lower one
BUTTON, PLAY, GAP, SPEED = 32.0, 44.0, 4.0, 40.0
# Widths below which buttons are left out: of speed, of steps, of what keys do as well.
ROOMY, NARROW, TINY = 760.0, 600.0, 460.0
ANNOTATED = (520.0, 420.0)  # smaller windows show the plant and the timeline alone
WIPE_REACH = 9.0  # how far from the wipe's line the mouse still takes hold of it

TOOLS = (
    "color", "smaller", "larger", "ground", "turn", "fit", "picture", "fullscreen", "panel", "help",
)  # fmt: skip
TINY_TOOLS = ("color", "ground", "fit", "panel", "help")
# Font Awesome 6, by the name of the action that the button does.
ICONS = {
    "previous": "\uf048",
    "next": "\uf051",
    "slower": "\uf068",
    "faster": "\uf067",
    "color": "\uf53f",
    "smaller": "\uf056",
    "larger": "\uf055",
    "turn": "\uf2f9",
    "fit": "\uf05b",
    "picture": "\uf030",
    "panel": "\uf1de",
    "help": "\uf128",
}
AT_END = {AtEnd.LOOP: "\uf363", AtEnd.PING_PONG: "\uf07e", AtEnd.STOP: "\uf061"}
SPEEDS = {0.125: "⅛×", 0.25: "¼×", 0.5: "½×"}


@dataclass(frozen=True)
class Facts:
    """What is to be told beside the scene itself."""

    values: ValueRange | None = None  #: what the colours stand for
    organ: tuple[tuple[str, str], ...] = ()  #: of the picked one, (what, value) pairs
    panes: Sequence[Pane] = ()  #: what is compared, from left to right; none where nothing is
    exporting: Exporting | None = None  #: an export under way
    curves: Sequence[TraitCurve] = ()  #: the picked organ's traits over time


class Interface:
    """Belongs to one clip in one window, where the user calls it `name`.

    popup: whether a list is open that Esc is to close.
    """

    def __init__(self, gui: Gui, clip: Clip, name: str) -> None:
        self._gui, self._name = gui, name
        self.timeline = TimelineView(clip)
        self.mouse = PlantMouse()
        self.popup = False

    def draw(
        self,
        framebuffer: moderngl.Framebuffer,
        scene: Scene,
        size: tuple[float, float],
        scale: float,
        facts: Facts | None = None,
    ) -> Scene:
        """Draw over a framebuffer that holds the plant, and give the scene as the mouse changed it.

        size, scale: (width, height) of the window in units, and the pixels in a unit.
        """
        shown, facts = scene, facts or Facts()
        self._gui.begin(size, scale, theme_of(scene.style.ground))
        area = (size[0] - panel_width(size[0], scene.panel and not scene.kiosk), size[1])
        back = imgui.get_background_draw_list()
        margin, below = _margin(area), BOTTOM + strip_height(scene, area[1])
        below += CAPTION if facts.panes else 0.0
        pen = Pen(self._gui, back, area, (margin, TOP - 8.0, margin, below))
        scene = self.mouse.move(scene, area)
        if shown.kiosk:
            self._draw_kiosk(pen, shown)
        else:
            self._draw_veils(pen)
            self._draw_annotations(pen, shown, facts)
            scene = self._draw_title(pen, scene)
            scene = self._draw_controls(pen, scene, facts)
            if shown.compare is Compare.WIPE:
                scene = _draw_wipe(pen, scene)
            if shown.panel:
                place = panel_place(size, (TOP, BOTTOM))
                scene = draw_panel(scene, self._gui, place, facts.exporting)
        if shown.help:
            scene = draw_help(scene, self._gui, size)
        if shown.notice:
            front = Pen(self._gui, imgui.get_foreground_draw_list(), area)
            front.card(area[0] / 2, TOP - 12.0, shown.notice, 15.0, area[0] - 40.0)
        either = imgui.PopupFlags_.any_popup_id | imgui.PopupFlags_.any_popup_level
        self.popup = imgui.is_popup_open("", either)
        self._gui.end(framebuffer)
        return scene

    def _draw_veils(self, pen: Pen) -> None:
        """The ground's colour, to calm it behind what is written above and below."""
        (width, height), veil = pen.size, pen.theme.veil
        for top, bottom, above, below in (
            (0.0, TOP, 0.6, 0.0),
            (height - BOTTOM, height, 0.0, 0.85),
        ):
            upper, lower = packed(faint(veil, above)), packed(faint(veil, below))
            corners = (0.0, top), (width, bottom)
            pen.sheet.add_rect_filled_multi_color(*corners, upper, upper, lower, lower)

    def _draw_title(self, pen: Pen, scene: Scene) -> Scene:
        """The clip's name, and the buttons beside it."""
        theme, margin = pen.theme, _margin(pen.size)
        tools = TOOLS if pen.size[0] >= TINY else TINY_TOOLS
        width = len(tools) * (BUTTON + GAP) - GAP
        room = pen.size[0] - width - 2 * margin - 12.0
        name = pen.fitted(self._name, 20.0, room, bold=True)
        pen.write(margin, margin + 9.0, name, 20.0, theme.text, bold=True)
        scans, organs = len(scene.clip.scans), len(scene.clip.track_table)
        text = pen.fitted(f"{scans} scans, {organs} organs", 15.0, room)
        pen.write(margin, margin + 31.0, text, 15.0, theme.muted)
        with bare_window("tools", (pen.size[0] - margin - width, margin), (width, BUTTON)):
            for place, name in enumerate(tools):
                imgui.set_cursor_pos((place * (BUTTON + GAP), 0.0))
                on = (name == "turn" and scene.turning) or (name == "panel" and scene.panel)
                scene = icon_button(scene, name, _icon(name, scene), on)
        return scene

    def _draw_controls(self, pen: Pen, scene: Scene, facts: Facts) -> Scene:
        """The timeline, and the buttons at both of its ends."""
        theme, (width, height), margin = pen.theme, pen.size, _margin(pen.size)
        middle = CONTROLS - 50.0  # of the line, from the window's top
        with bare_window("controls", (0.0, height - CONTROLS), (width, CONTROLS)):
            x = margin
            for name in ("previous", "play", "next") if width >= NARROW else ("play",):
                side = PLAY if name == "play" else BUTTON
                imgui.set_cursor_pos((x, middle - side / 2))
                if name == "play":
                    scene = _play_button(pen, scene)
                else:
                    scene = icon_button(scene, name, _icon(name, scene))
                x += side + GAP
            right = width - margin
            for name in ("at end", "faster", "slower") if width >= ROOMY else ("at end",):
                right -= BUTTON
                imgui.set_cursor_pos((right, middle - BUTTON / 2))
                scene = icon_button(scene, name, _icon(name, scene))
                if name == "faster":
                    right -= SPEED
                    speed = scene.timeline.speed
                    text, line = SPEEDS.get(speed, f"{speed:.0f}×"), height - 50.0
                    pen.write(right + SPEED / 2, line, text, 17.0, theme.text, True, 0.5)
            least = 8.0 if width >= NARROW else x
            ends = x - GAP + margin, right - margin
            if facts.curves and strip_height(scene, height):
                color = scene.clip.track_table[facts.curves[0].track].color
                scene = draw_curve(pen, scene, facts.curves, color, ends, height - BOTTOM)
            scene = self.timeline.draw(pen, scene, ends, least)
        if width >= ROOMY:
            self.timeline.draw_key(pen, right + 8.0, height - 25.0)
        return scene

    def _draw_annotations(self, pen: Pen, scene: Scene, facts: Facts) -> None:
        clip, picked = scene.clip, scene.style.picked
        bottom = BOTTOM + strip_height(scene, pen.size[1])
        draw_captions(pen, facts.panes, bottom)
        if pen.size[0] >= ANNOTATED[0] and pen.size[1] >= ANNOTATED[1]:
            draw_guides(pen, scene, clip, facts.values)
        if picked is not None and pen.size[1] >= 320.0:
            draw_organ(pen, clip.track_table[picked], facts.organ)
        if facts.exporting is not None:
            draw_progress(pen, facts.exporting, bottom)

    def _draw_kiosk(self, pen: Pen, scene: Scene) -> None:
        """The date, and nothing that could be pressed."""
        x, y = _margin(pen.size) + 8.0, pen.size[1] - _margin(pen.size) - 16.0
        date = date_at(scene.clip.scans, scene.timeline.day)
        pen.write(x, y, date, 26.0, pen.theme.text, bold=True)
        pen.write(x, y - 32.0, self._name, 17.0, pen.theme.muted)


def _play_button(pen: Pen, scene: Scene) -> Scene:
    """A large round one, where ImGui's cursor is; a button's own corners are not quite round."""
    left, top = imgui.get_cursor_screen_pos()
    middle, theme = (left + PLAY / 2, top + PLAY / 2), pen.theme
    pen.sheet.add_circle_filled(middle, PLAY / 2, packed(theme.accent), 64)
    imgui.push_style_var(imgui.StyleVar_.frame_rounding, PLAY / 2)
    scene = button(scene, "play", _icon("play", scene), (PLAY, PLAY), CLEAR, theme.on_accent)
    imgui.pop_style_var()
    return scene


def _draw_wipe(pen: Pen, scene: Scene) -> Scene:
    """The line between what is compared, which the mouse moves."""
    (width, height), x = pen.size, scene.wipe * pen.size[0]
    size = (2 * WIPE_REACH, height - TOP - BOTTOM)
    if size[1] <= 0.0:
        return scene
    with bare_window("wipe", (x - WIPE_REACH, TOP), size):
        imgui.invisible_button("line", size)
        if imgui.is_item_active() or imgui.is_item_deactivated():
            scene = actions.wipe_to(imgui.get_mouse_pos().x / width)(scene)
    return scene


def _icon(name: str, scene: Scene) -> str:
    timeline = scene.timeline
    return {
        **ICONS,
        "play": "\uf04c" if timeline.playing else "\uf04b",
        "at end": AT_END[timeline.at_end],
        "ground": "\uf185" if scene.style.ground == "dark" else "\uf186",
        "fullscreen": "\uf066" if scene.fullscreen else "\uf065",
    }[name]


def _margin(size: tuple[float, float]) -> float:
    return 24.0 if size[0] >= NARROW else 14.0
