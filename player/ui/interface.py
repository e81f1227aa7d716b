"""What lies over the plant: title, buttons, timeline, annotations, notices, panel and help."""

from collections.abc import Sequence

from imgui_bundle import imgui, imgui_ctx
from moderngl import Framebuffer

from gclip import Clip
from player.ui import actions, annotations, keys
from player.ui.annotations import strip_height
from player.ui.gui import Gui, PlantMouse
from player.ui.help import draw_help
from player.ui.organ_info import OrganInfo
from player.ui.panel import draw_panel, panel_width
from player.ui.theme import DARK, LIGHT, Pen, faint, one_line, packed
from player.ui.timeline import Line, TimelineView
from player.ui.widgets import FLAGS, bare_window, button, card
from player.view.choices import Compare
from player.view.colors import Colors
from player.view.playback import AtEnd
from player.view.split_view import Pane
from player.view.state import Scene

Size = tuple[float, float]  # width and height in units
TOP, BOTTOM = 80.0, 124.0  # heights of the strips that hold title and buttons, and the timeline
CAPTION = 36.0  # of the one that tells what is compared
CONTROLS = 84.0  # height of what the mouse can hold in the lower one
MARGIN, BUTTON, PLAY, GAP, SPEED = 24.0, 32.0, 44.0, 4.0, 40.0
WIPE_REACH = 9.0  # how far from the wipe's line the mouse still takes hold of it

TOOLS = (
    "smaller", "larger", "turn", "picture", "fullscreen", "ground", "color", "fit", "panel", "help",
)  # fmt: skip
BEFORE, AFTER = ("previous", "play", "next"), ("slower", "faster", "at end")  # the timeline
WIDTHS = {"play": PLAY, "slower": BUTTON + SPEED}  # other than BUTTON's
# Font Awesome 6, by the name of the action that the button does; the second one while it is on.
ICONS = {
    "previous": "\uf048",
    "play": "\uf04b\uf04c",
    "next": "\uf051",
    "slower": "\uf068",
    "faster": "\uf067",
    "color": "\uf53f",
    "smaller": "\uf056",
    "larger": "\uf055",
    "turn": "\uf2f9",
    "fit": "\uf05b",
    "picture": "\uf030",
    "ground": "\uf185\uf186",
    "fullscreen": "\uf065\uf066",
    "panel": "\uf1de",
    "help": "\uf128",
}
AT_END = {AtEnd.LOOP: "\uf363", AtEnd.PING_PONG: "\uf07e", AtEnd.STOP: "\uf061"}
SPEEDS = {0.125: "⅛×", 0.25: "¼×", 0.5: "½×"}


class Interface:
    """Belongs to one clip in one window, where the user calls it `name`.

    organs: what is known of them.
    """

    def __init__(self, gui: Gui, clip: Clip, name: str) -> None:
        self._gui, self._name = gui, name
        self._colors, self.organs = Colors(clip), OrganInfo(clip)
        self.timeline, self.mouse = TimelineView(clip), PlantMouse()

    def draw(
        self, screen: Framebuffer, scene: Scene, size: Size, scale: float, panes: Sequence[Pane]
    ) -> Scene:
        """Draw over a screen that holds the plant, and give the scene as the mouse changed it.

        size, scale: (width, height) of the window in units, and the pixels in a unit.
        panes:       what is seen, from left to right.
        """
        shown, self.organs.measuring = scene, False
        self._gui.begin(size, scale, LIGHT if scene.style.ground == "light" else DARK)
        area = (size[0] - panel_width(scene), size[1])
        bottom, picked = BOTTOM + strip_height(scene), scene.style.picked
        below = bottom + (CAPTION if len(panes) > 1 else 0.0)
        pen = Pen(self._gui.theme, self._gui.bold, area, (MARGIN, TOP - 8.0, MARGIN, below))
        scene = self.mouse.move(scene, area)
        _draw_veils(pen)
        annotations.draw_guides(pen, shown, self._colors.color_scale(shown.style))
        annotations.draw_captions(pen, panes, bottom)
        if picked is not None:
            facts = self.organs.lines(shown.clip, picked, shown.timeline.day)
            annotations.draw_organ(pen, shown.clip.track_table[picked], facts)
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
        """The clip's name, and the buttons beside it."""
        left = pen.size[0] - MARGIN - _width(TOOLS)
        with bare_window("title", (MARGIN,) * 2, (left - MARGIN - 12.0, 44.0), FLAGS.no_inputs):
            with imgui_ctx.push_font(pen.bold, 20.0):
                imgui.text_unformatted(one_line(self._name))
            scans, organs = len(scene.clip.scans), len(scene.clip.track_table)
            imgui.text_disabled(f"{scans} scans, {organs} organs")
        with bare_window("tools", (left, MARGIN), (_width(TOOLS), BUTTON)):
            return _row(scene, TOOLS, left, MARGIN + BUTTON / 2)

    def _draw_controls(self, pen: Pen, scene: Scene) -> Scene:
        """The timeline, and the buttons at both of its ends."""
        (width, height), picked = pen.size, scene.style.picked
        middle, right = height - 50.0, width - MARGIN - _width(AFTER)  # of the line; the buttons'
        with bare_window("controls", (0.0, height - CONTROLS), (width, CONTROLS)):
            scene = _row(scene, BEFORE, MARGIN, middle)
            scene = _row(scene, AFTER, right, middle)
            left, others = 2 * MARGIN + _width(BEFORE), [one.time for one in scene.clip.held_out]
            ends = left, max(right - MARGIN, left + 1.0)
            line = Line(*ends, middle, (*scene.clip.times,), (*others,))
            if picked is not None and scene.curve:
                curves = self.organs.curves(picked)
                scene = annotations.draw_curve(pen, scene, curves, line, height - BOTTOM)
            scene = self.timeline.draw(pen, scene, line)
        speed, x = scene.timeline.speed, right + BUTTON + (GAP + SPEED) / 2
        pen.write(x, middle, SPEEDS.get(speed, f"{speed:.0f}×"), 17.0, pen.theme.text, True, 0.5)
        self.timeline.draw_key(pen, right + 16.0, height - 25.0)
        return scene


def _draw_veils(pen: Pen) -> None:
    """The ground's colour, to calm it behind what is written above and below."""
    (width, height), veil = pen.size, pen.theme.veil
    clear, upper, lower = (packed(faint(veil, alpha)) for alpha in (0.0, 0.6, 0.85))
    draw = pen.sheet.add_rect_filled_multi_color
    draw((0.0, 0.0), (width, TOP), upper, upper, clear, clear)
    draw((0.0, height - BOTTOM), (width, height), clear, clear, lower, lower)


def _draw_wipe(pen: Pen, scene: Scene) -> Scene:
    """The line between what is compared, which the mouse moves."""
    (width, height), x = pen.size, scene.wipe * pen.size[0]
    size = (2 * WIPE_REACH, height - TOP - BOTTOM)
    with bare_window("wipe", (x - WIPE_REACH, TOP), size):
        imgui.invisible_button("line", size)
        held = imgui.is_item_active() or imgui.is_item_deactivated()
        return actions.wipe_to(scene, imgui.get_mouse_pos().x / width) if held else scene


def _draw_notice(notice: str, area: Size) -> None:
    """Over everything, even the help."""
    with card("notice", (area[0] / 2, TOP - 12.0), (0.5, 0.0), area[0], FLAGS.tooltip):
        imgui.push_text_wrap_pos(area[0] - 60.0)
        imgui.text_unformatted(one_line(notice, 800))
        imgui.pop_text_wrap_pos()


def _width(names: Sequence[str]) -> float:
    """Of a row of buttons."""
    return sum(WIDTHS.get(name, BUTTON) + GAP for name in names) - GAP


def _row(scene: Scene, names: Sequence[str], left: float, middle: float) -> Scene:
    """Icon buttons in a row about a height, a large one among them; what is on has the accent."""
    part, color, paint = imgui.Col_, imgui.get_style_color_vec4, imgui_ctx.push_style_color
    for name in names:
        action, side = keys.ACTIONS[name], PLAY if name == "play" else BUTTON
        on = bool(action.on and action.on(scene))
        icon = AT_END[scene.timeline.at_end] if name == "at end" else ICONS[name][-1 if on else 0]
        ground, text = part.button, part.check_mark if on else part.text
        if name == "play":
            ground, text = part.check_mark, part.window_bg
        imgui.set_cursor_screen_pos((left, middle - side / 2))
        with paint(part.button, color(ground)), paint(part.text, color(text)):
            scene = button(scene, name, icon, (side, side))
        left += WIDTHS.get(name, BUTTON) + GAP
    return scene
