"""The help: every key and mouse action, straight from the table in keys.py."""

from __future__ import annotations

from dataclasses import replace

from imgui_bundle import imgui, imgui_ctx

from player.ui import keys
from player.ui.gui import Gui
from player.ui.theme import Theme, packed
from player.ui.widgets import BARE, key_labels
from player.view.state import Scene

COLUMNS = (("Time", "Organs"), ("View", "Compare"), ("Look", "Window"))
FEWER_COLUMNS = (("Time", "Organs", "Look"), ("View", "Compare", "Window"))
WIDE = 1.5  # of a window, times its height: from there on all columns make larger letters
TITLE, TEXT, CAP = 21.0, 15.5, 13.0  # sizes of letters
PADDING, BETWEEN, GAP = 26.0, 40.0, 12.0  # of the card, of its columns, of keys and their meaning
CAP_PADDING, CAP_GAP = 7.0, 4.0
EDGE = 12.0  # what the card keeps from the window's
SLACK = 0.985  # small letters are wider for their size: they snap to pixels


class Help:
    """Over everything, and smaller where the window is."""

    def __init__(self) -> None:
        self._size, self._scale = (0.0, 0.0), 1.0

    def draw(self, scene: Scene, gui: Gui, theme: Theme, size: tuple[float, float]) -> Scene:
        """Draw it in a window of `size` units; a click closes it."""
        if size != self._size:
            self._size, self._scale = size, 1.0
        imgui.set_next_window_pos((0.0, 0.0))
        imgui.set_next_window_size(size)
        with imgui_ctx.begin("shade", None, BARE):
            imgui.get_window_draw_list().add_rect_filled((0.0, 0.0), size, packed(theme.shade))
        imgui.set_next_window_pos((size[0] / 2, size[1] / 2), 0, (0.5, 0.5))
        imgui.push_style_var(imgui.StyleVar_.window_rounding, 14.0)
        imgui.push_style_var(imgui.StyleVar_.window_border_size, 1.0)
        imgui.push_style_var(imgui.StyleVar_.window_padding, 2 * (PADDING * self._scale,))
        imgui.push_style_var(
            imgui.StyleVar_.item_spacing, (CAP_GAP * self._scale, 5.0 * self._scale)
        )
        imgui.push_style_color(imgui.Col_.window_bg, imgui.ImVec4(*theme.card))
        flags = BARE & ~imgui.WindowFlags_.no_background | imgui.WindowFlags_.always_auto_resize
        with imgui_ctx.begin("help", None, flags):
            with imgui_ctx.begin_group():
                self._draw_card(gui, theme)
            wide, high = imgui.get_item_rect_size()
        imgui.pop_style_color()
        imgui.pop_style_var(4)
        edge, around = 2 * EDGE, 2 * PADDING * self._scale
        beyond = max((wide + around) / (size[0] - edge), (high + around) / (size[1] - edge))
        self._scale *= SLACK / beyond if beyond > 1.0 else 1.0
        pressed = any(imgui.is_mouse_clicked(button) for button in range(3))
        return replace(scene, help=False) if pressed else scene

    def _draw_card(self, gui: Gui, theme: Theme) -> None:
        with imgui_ctx.push_font(gui.bold, TITLE * self._scale):
            imgui.text_unformatted("Keys and mouse")
        with imgui_ctx.push_font(None, TEXT * self._scale):
            imgui.same_line(0.0, 16.0 * self._scale)
            imgui.text_colored(theme.muted, "Esc, or a click, closes this")
            imgui.new_line()
            wide = self._size[0] >= WIDE * self._size[1]
            for number, sections in enumerate(COLUMNS if wide else FEWER_COLUMNS):
                if number:
                    imgui.same_line(0.0, BETWEEN * self._scale)
                with imgui_ctx.begin_group():
                    self._draw_column(gui, theme, sections)

    def _draw_column(self, gui: Gui, theme: Theme, sections: tuple[str, ...]) -> None:
        table, left = keys.sections(), imgui.get_cursor_pos_x()
        beside = (2 * CAP_PADDING + CAP_GAP) * self._scale
        rows = {name: [(key_labels(keys), text) for keys, text in table[name]] for name in sections}
        with imgui_ctx.push_font(gui.bold, CAP * self._scale):
            widths = {
                (name, row): sum(imgui.calc_text_size(label).x + beside for label in labels)
                for name in sections
                for row, (labels, _) in enumerate(rows[name])
            }
        middle = left + max(widths.values())
        for name in sections:
            with imgui_ctx.push_font(gui.bold, TEXT * self._scale):
                imgui.set_cursor_pos_x(middle + GAP * self._scale)
                imgui.text_colored(theme.accent, name)
            for row, (labels, text) in enumerate(rows[name]):
                imgui.set_cursor_pos_x(middle - widths[name, row])
                self._draw_keys(gui, labels)
                imgui.set_cursor_pos_x(middle + GAP * self._scale)
                imgui.text_unformatted(text)
            imgui.dummy((0.0, 6.0 * self._scale))

    def _draw_keys(self, gui: Gui, labels: list[str]) -> None:
        imgui.begin_disabled()
        imgui.push_style_var(imgui.StyleVar_.alpha, 1.0)
        imgui.push_style_var(
            imgui.StyleVar_.frame_padding, (CAP_PADDING * self._scale, 2.0 * self._scale)
        )
        with imgui_ctx.push_font(gui.bold, CAP * self._scale):
            for label in labels:
                imgui.button(label)
                imgui.same_line(0.0, CAP_GAP * self._scale)
        imgui.pop_style_var(2)
        imgui.end_disabled()
