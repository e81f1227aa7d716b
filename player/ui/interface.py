"""The user interface over the plant: title, buttons, timeline, annotations, panel and help."""

from collections.abc import Sequence

from imgui_bundle import imgui, imgui_ctx
from moderngl import Framebuffer

from player.ui import actions, annotations, keys
from player.ui.gui import Gui, PlantMouse
from player.ui.help import draw_help
from player.ui.organ_info import OrganInfo
from player.ui.panel import draw_panel, panel_width
from player.ui.theme import DARK, LIGHT, Pen, one_line, to_u32, with_alpha
from player.ui.timeline import Line, TimelineView
from player.ui.widgets import FLAGS, Point, bare_window, button, card
from player.view.choices import Compare
from player.view.colors import Colors
from player.view.playback import AtEnd
from player.view.split_view import Pane
from player.view.state import Scene

TOP, BOTTOM = 80.0, 124.0  # heights of the strips with title and buttons, and with the timeline
CAPTION_HEIGHT = 36.0  # of the captions of panes
CONTROLS_HEIGHT = 84.0  # of the window with the controls in the lower strip
MARGIN, GAP = 24.0, 4.0  # around the interface, and between buttons
BUTTON, PLAY_BUTTON, SPEED_WIDTH = 32.0, 44.0, 40.0  # sides of buttons, and width of the speed
WIPE_TOLERANCE = 9.0  # distance from the wipe's line at which the mouse can drag it

TOOLS = (
    "smaller", "larger", "turn", "picture", "fullscreen", "ground", "color", "fit", "panel", "help",
)  # fmt: skip
# Buttons left and right of the timeline
BEFORE, AFTER = ("previous", "play", "next"), ("slower", "faster", "at end")
WIDTHS = {"play": PLAY_BUTTON, "slower": BUTTON + SPEED_WIDTH}  # other than BUTTON
# Characters of Font Awesome 6 by the name of the action; the last one while the action is on.
ICONS = {
    "previous": "\uf048", "play": "\uf04b\uf04c", "next": "\uf051", "slower": "\uf068",
    "faster": "\uf067", "color": "\uf53f", "smaller": "\uf056", "larger": "\uf055",
    "turn": "\uf2f9", "fit": "\uf05b", "picture": "\uf030", "ground": "\uf185\uf186",
    "fullscreen": "\uf065\uf066", "panel": "\uf1de", "help": "\uf128",
}  # fmt: skip
AT_END = {AtEnd.LOOP: "\uf363", AtEnd.PING_PONG: "\uf07e", AtEnd.STOP: "\uf061"}
SPEEDS = {0.125: "⅛×", 0.25: "¼×", 0.5: "½×"}


class Interface:
    """The interface of one window; `names` are those of its clips, `organs` measures traits."""

    def __init__(self, gui: Gui, colors: Colors, *names: str) -> None:
        self._gui, self._colors, self._name = gui, colors, " · ".join(names)
        self.organs, self.timeline = OrganInfo(colors.clip), TimelineView(colors.clip)
        self.mouse = PlantMouse()

    def draw(
        self, screen: Framebuffer, scene: Scene, size: Point, scale: float, panes: Sequence[Pane]
    ) -> Scene:
        """Draw the interface over the plant, and return the scene as the mouse changed it.

        size, scale: (width, height) of the window in units of 1/96 inch, and pixels per unit.
        panes:       parts of the window that show clips, from left to right.
        """
        shown, self.organs.measuring = scene, False
        self._gui.begin(size, scale, LIGHT if scene.style.ground == "light" else DARK)
        area = (size[0] - panel_width(scene), size[1])
        bottom, picked = BOTTOM + annotations.plot_height(scene), scene.style.picked
        below = bottom + (CAPTION_HEIGHT if len(panes) > 1 else 0.0)
        pen = Pen(self._gui.theme, self._gui.bold, area, (MARGIN, TOP - 8.0, MARGIN, below))
        scene = self.mouse.move(scene, area)
        _draw_gradients(pen)
        annotations.draw_guides(pen, shown, self._colors.value_range(shown.style))
        annotations.draw_captions(pen, panes, bottom)
        if picked is not None:
            facts = self.organs.lines(shown.clip, picked, shown.timeline.day)
            annotations.draw_organ_card(pen, shown.clip.track_table[picked], facts)
        if shown.exporting is not None:
            annotations.draw_progress(pen, shown.exporting, bottom)
        scene = self._draw_title(pen, scene)
        scene = self._draw_controls(pen, scene)
        if shown.compare is Compare.WIPE:
            scene = _draw_wipe(pen, scene)
        if shown.panel:
            scene = draw_panel(scene, self._gui, size)
        if shown.help:
            scene = draw_help(scene, self._gui, size)
        if shown.notice:
            _draw_notice(shown.notice, area)
        self._gui.end(screen)
        return scene

    def _draw_title(self, pen: Pen, scene: Scene) -> Scene:
        """Draw the clip's name, and the buttons beside it."""
        left = pen.size[0] - MARGIN - _width(TOOLS)
        with bare_window("title", (MARGIN,) * 2, (left - MARGIN - 12.0, 44.0), FLAGS.no_inputs):
            with imgui_ctx.push_font(pen.bold, 20.0):
                imgui.text_unformatted(one_line(self._name))
            scans, organs = len(scene.clip.scans), len(scene.clip.track_table)
            imgui.text_disabled(f"{scans} scans, {organs} organ{'s' * (organs != 1)}")
        with bare_window("tools", (left, MARGIN), (_width(TOOLS), BUTTON)):
            return _row(scene, TOOLS, left, MARGIN + BUTTON / 2)

    def _draw_controls(self, pen: Pen, scene: Scene) -> Scene:
        """Draw the timeline, and the buttons at both of its ends."""
        (width, height), picked = pen.size, scene.style.picked
        middle, right = height - 50.0, width - MARGIN - _width(AFTER)  # line; right-hand buttons
        with bare_window("controls", (0.0, height - CONTROLS_HEIGHT), (width, CONTROLS_HEIGHT)):
            scene = _row(scene, BEFORE, MARGIN, middle)
            scene = _row(scene, AFTER, right, middle)
            left, held_out = 2 * MARGIN + _width(BEFORE), [s.time for s in scene.clip.held_out]
            ends = left, max(right - MARGIN, left + 1.0)
            line = Line(*ends, middle, (*scene.clip.times,), (*held_out,))
            if picked is not None and scene.curve:
                curves = self.organs.curves(picked)
                scene = annotations.draw_curve(pen, scene, curves, line, height - BOTTOM)
            scene = self.timeline.draw(pen, scene, line)
        speed, x = scene.timeline.speed, right + BUTTON + (GAP + SPEED_WIDTH) / 2
        pen.write(x, middle, SPEEDS.get(speed, f"{speed:.0f}×"), 17.0, pen.theme.text, True, 0.5)
        self.timeline.draw_legend(pen, right + 16.0, height - 25.0)
        return scene


def _draw_gradients(pen: Pen) -> None:
    """Cover the background behind title and timeline with its own colour, for legible text."""
    (width, height), veil = pen.size, pen.theme.veil
    clear, upper, lower = (to_u32(with_alpha(veil, alpha)) for alpha in (0.0, 0.6, 0.85))
    draw = pen.sheet.add_rect_filled_multi_color
    draw((0.0, 0.0), (width, TOP), upper, upper, clear, clear)
    draw((0.0, height - BOTTOM), (width, height), clear, clear, lower, lower)


def _draw_wipe(pen: Pen, scene: Scene) -> Scene:
    """Let the mouse drag the line between the panes."""
    (width, height), x = pen.size, scene.wipe * pen.size[0]
    size = (2 * WIPE_TOLERANCE, height - TOP - BOTTOM)
    with bare_window("wipe", (x - WIPE_TOLERANCE, TOP), size):
        imgui.invisible_button("line", size)
        dragged = imgui.is_item_active() or imgui.is_item_deactivated()
        return actions.wipe_to(scene, imgui.get_mouse_pos().x / width) if dragged else scene


def _draw_notice(notice: str, area: Point) -> None:
    """Draw a notice above everything else, including the help."""
    with card("notice", (area[0] / 2, TOP - 12.0), (0.5, 0.0), area[0], FLAGS.tooltip):
        imgui.push_text_wrap_pos(area[0] - 60.0)
        imgui.text_unformatted(one_line(notice, 800))
        imgui.pop_text_wrap_pos()


def _width(names: Sequence[str]) -> float:
    """Width of a row of buttons."""
    return sum(WIDTHS.get(name, BUTTON) + GAP for name in names) - GAP


def _row(scene: Scene, names: Sequence[str], left: float, middle: float) -> Scene:
    """Draw icon buttons in a row, centred about the height `middle`."""
    part, color, push_color = imgui.Col_, imgui.get_style_color_vec4, imgui_ctx.push_style_color
    for name in names:
        action, side = keys.ACTIONS[name], PLAY_BUTTON if name == "play" else BUTTON
        on = bool(action.on and action.on(scene))
        icon = AT_END[scene.timeline.at_end] if name == "at end" else ICONS[name][-1 if on else 0]
        ground, text = part.button, part.check_mark if on else part.text
        if name == "play":
            ground, text = part.check_mark, part.window_bg
        imgui.set_cursor_screen_pos((left, middle - side / 2))
        with push_color(part.button, color(ground)), push_color(part.text, color(text)):
            scene = button(scene, name, icon, (side, side))
        left += WIDTHS.get(name, BUTTON) + GAP
    return scene
