"""Annotations in the window: guides, captions, the picked organ and its plot, export progress."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from imgui_bundle import imgui, imgui_ctx

from gclip import Track
from player.ui.theme import Pen, one_line, rgb, to_u32, with_alpha
from player.ui.timeline import Line
from player.ui.widgets import bare_window, button, card
from player.view.annotations import (
    LINE_HEIGHT,
    MAX_NAME_LENGTH,
    draw_color_bar,
    draw_organ_legend,
    draw_scale_bar,
)
from player.view.camera import Camera
from player.view.colors import ValueRange, format_number
from player.view.split_view import Pane
from player.view.state import ExportProgress, Scene
from traits.curves import TraitCurve

# Lengths in units of 1/96 inch
FONT_SIZE, AXIS_LENGTH, WIPE_HANDLE_RADIUS, PROGRESS_WIDTH = 14.0, 24.0, 13.0, 270.0
PLOT_HEIGHT, STRIP_HEIGHT, BUTTON_HEIGHT = 76.0, 96.0, 26.0  # the strip includes plot and margins
LABEL_GAP, MARKER_RADIUS = 14.0, 3.5  # between labels and plot; of the plot's markers
DOT_ICON, ARROWS_ICON = "\uf111", "\uf337"


def draw_guides(pen: Pen, scene: Scene, values: ValueRange | None) -> None:
    """Draw scale bar and axes, and a legend of the colours: a colour bar if there are `values`."""
    if scene.guides:
        draw_scale_bar(pen, scene.camera, scene.clip.unit)
        draw_axes(pen, scene.camera)
    if scene.legend and values is not None:
        draw_color_bar(pen, values)
    elif scene.legend and scene.color_mode == "track":
        max_height = pen.size[1] - pen.insets[1] - pen.insets[3] - 2 * LINE_HEIGHT
        draw_organ_legend(pen, scene.clip.track_table, max_height)


def draw_axes(pen: Pen, camera: Camera) -> None:
    """Draw the axes of the input's coordinates, the farthest first."""
    left, _, _, bottom = pen.insets
    x, y = left + AXIS_LENGTH, pen.size[1] - bottom - AXIS_LENGTH
    rotation = camera.view()[:3, :3]
    for axis in np.argsort(rotation[2]):
        right, up = (AXIS_LENGTH * rotation[:2, axis]).tolist()
        color = pen.theme.axes[axis]
        pen.sheet.add_line((x, y), (x + right, y - up), to_u32(color), 2.5)
        label_at = (x + 1.4 * right, y - 1.4 * up)
        pen.write(*label_at, "xyz"[axis], FONT_SIZE, color, bold=True, align=0.5)


def draw_organ_card(pen: Pen, organ: Track, facts: Sequence[tuple[str, str]]) -> None:
    """Draw a card with name and facts of the picked organ below the title."""
    with card("organ", pen.insets[:2], (0.0, 0.0), pen.size[0]):
        imgui.text_colored(rgb(organ.color), DOT_ICON)
        imgui.same_line()
        with imgui_ctx.push_font(pen.bold, 16.0):
            imgui.text_unformatted(one_line(organ.name, MAX_NAME_LENGTH))
        with imgui_ctx.begin_table("facts", 2, imgui.TableFlags_.sizing_fixed_fit):
            for label, value in facts:
                imgui.table_next_column()
                imgui.text_disabled(one_line(label, MAX_NAME_LENGTH))
                imgui.table_next_column()
                imgui.text_unformatted(one_line(value, MAX_NAME_LENGTH))


def draw_captions(pen: Pen, panes: Sequence[Pane], bottom: float) -> None:
    """Draw the line between panes, and their captions `bottom` units above the lower edge."""
    (width, height), theme = pen.size, pen.theme
    for pane in panes[1:]:
        x, middle = pane.left * width, height / 2
        pen.sheet.add_line((x, 0.0), (x, height - bottom + 20.0), to_u32(theme.track), 2.0)
        if not pane.is_whole:
            pen.sheet.add_circle_filled((x, middle), WIPE_HANDLE_RADIUS, to_u32(theme.card))
            pen.write(x, middle, ARROWS_ICON, FONT_SIZE, theme.text, align=0.5)
    for index, pane in enumerate(panes):
        if pane.caption:
            position = (pane.left + pane.right) / 2 * width, height - bottom - 15.0
            with card(f"caption {index}", position, (0.5, 0.0), width):
                imgui.text_unformatted(one_line(pane.caption, MAX_NAME_LENGTH))


def draw_progress(pen: Pen, export: ExportProgress, bottom: float) -> None:
    """Draw the progress of an export in the middle above the timeline."""
    with card("export", (pen.size[0] / 2, pen.size[1] - bottom - 20.0), (0.5, 1.0), pen.size[0]):
        text = f"{one_line(export.name, MAX_NAME_LENGTH)}: E stops it"
        imgui.progress_bar(export.done / max(export.total, 1), (PROGRESS_WIDTH, 0.0), text)


def plot_height(scene: Scene) -> float:
    """Height in units that the plot of a trait takes from the window; 0 if there is none."""
    return STRIP_HEIGHT if scene.style.picked is not None and scene.curve else 0.0


def draw_curve(
    pen: Pen, scene: Scene, curves: Sequence[TraitCurve], line: Line, bottom: float
) -> Scene:
    """Draw the selected trait of the picked organ over time, with its margin of error.

    line: the timeline, whose x axis the plot shares; bottom: y coordinate of the plot's lower end.
    """
    curve = next((curve for curve in curves if curve.trait == scene.curve), None)
    if curve is None:
        return scene
    theme, sheet = pen.theme, pen.sheet
    color = scene.clip.track_table[curve.track].color
    stroke, left, top = to_u32(rgb(color)), line.left, bottom - PLOT_HEIGHT
    x, x_now = [line.x_of(time) for time in curve.times], line.x_of(scene.timeline.day)
    y, high, low = (
        [bottom - PLOT_HEIGHT * curve.level(v + side * margin) for v, margin in curve.points]
        for side in (0.0, 1.0, -1.0)
    )
    sheet.add_rect_filled((0.0, top - 10.0), pen.size, to_u32(with_alpha(theme.veil, 0.75)))
    sheet.add_line((left, bottom), (line.right, bottom), to_u32(theme.track))
    for i, j in pairwise(range(len(x))):
        corners = (x[i], high[i]), (x[j], high[j]), (x[j], low[j]), (x[i], low[i])
        sheet.add_quad_filled(*corners, to_u32(rgb(color, 0.25)))
        sheet.add_line((x[i], y[i]), (x[j], y[j]), stroke, 2.0)
    sheet.add_line((x_now, top), (x_now, bottom), to_u32(theme.accent))
    for i, sure in enumerate(curve.sure):
        fill = stroke if sure else to_u32(theme.veil)
        sheet.add_circle_filled((x[i], y[i]), MARKER_RADIUS, fill)
        sheet.add_circle((x[i], y[i]), MARKER_RADIUS, stroke, 0, 1.5)
    for value, height in ((curve.top, top + FONT_SIZE / 2), (curve.bottom, bottom - FONT_SIZE / 2)):
        text = format_number(value) + curve.unit
        pen.write(left - LABEL_GAP, height, text, FONT_SIZE, theme.muted, align=1.0)
    with bare_window("curve", (0.0, top + 22.0), (left - LABEL_GAP + 6.0, BUTTON_HEIGHT)):
        name = curve.trait.capitalize()
        width = pen.width(name, 15.0) + 18.0
        imgui.set_cursor_pos((max(left - LABEL_GAP + 6.0 - width, 0.0), 0.0))
        return button(scene, "curve", name, (width, BUTTON_HEIGHT))
