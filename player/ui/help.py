"""The help overlay: all key and mouse actions, from the table in keys.py."""

from dataclasses import replace

from imgui_bundle import imgui, imgui_ctx

from player.ui import keys
from player.ui.gui import Gui
from player.ui.theme import to_u32, with_alpha
from player.ui.widgets import FLAGS, SOLID, bare_window
from player.view.state import Scene

COLUMNS = (("Time", "Organs"), ("View", "Corrections", "Compare"), ("Look", "Export", "Window"))
WIDE_WINDOW = 1090.0  # units from which on all columns fit side by side
COLUMN_GAP, PADDING, EDGE = 36.0, 24.0, 12.0  # units; EDGE is kept free around the overlay


def draw_help(scene: Scene, gui: Gui, size: tuple[float, float]) -> Scene:
    """Draw the help over a window of `size` units; any click closes it."""
    with bare_window("shade", (0.0, 0.0), size):
        sheet, shade = imgui.get_window_draw_list(), to_u32(with_alpha(gui.theme.veil, 0.7))
        sheet.add_rect_filled((0.0, 0.0), size, shade)
    imgui.set_next_window_pos((size[0] / 2, size[1] / 2), 0, (0.5, 0.5))
    imgui.set_next_window_size_constraints((0.0, 0.0), (size[0] - 2 * EDGE, size[1] - 2 * EDGE))
    flags = SOLID & ~FLAGS.no_scrollbar | FLAGS.always_auto_resize
    with (
        imgui_ctx.push_style_var(imgui.StyleVar_.window_rounding, 14.0),
        imgui_ctx.push_style_var(imgui.StyleVar_.window_padding, (PADDING, PADDING)),
        imgui_ctx.push_style_color(imgui.Col_.window_bg, gui.theme.card),
        imgui_ctx.begin("help", None, flags),
    ):
        with imgui_ctx.push_font(gui.bold, 20.0):
            imgui.text_unformatted("Keys and mouse")
        imgui.same_line(0.0, 16.0)
        imgui.text_disabled("Esc, or a click, closes this")
        table = keys.sections()
        for names in COLUMNS:
            with imgui_ctx.begin_group():
                for name in names:
                    _draw_section(gui, name, table[name])
            if size[0] >= WIDE_WINDOW:
                imgui.same_line(0.0, COLUMN_GAP)
    pressed = any(imgui.is_mouse_clicked(button) for button in range(3))
    return replace(scene, help=False) if pressed else scene


def _draw_section(gui: Gui, name: str, rows: dict[str, list[str]]) -> None:
    imgui.dummy((0.0, 4.0))
    with imgui_ctx.push_font(gui.bold, 15.0):
        imgui.text_colored(gui.theme.accent, name)
    flags = imgui.TableFlags_.sizing_fixed_fit | imgui.TableFlags_.no_host_extend_x
    with imgui_ctx.begin_table(name, 2, flags):
        for text, labels in rows.items():
            imgui.table_next_column()
            imgui.text_unformatted("   ".join(labels))
            imgui.table_next_column()
            imgui.text_disabled(text)
