"""What helps to read the picture in the window: guides, captions, the picked organ and how it
grows, an export.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from imgui_bundle import imgui, imgui_ctx

from gclip import Track
from player.ui.theme import Pen, faint, one_line, packed, rgb
from player.ui.timeline import Line
from player.ui.widgets import bare_window, button, card
from player.view.annotations import LINE, MAX_NAME, draw_organs, draw_ramp, draw_scale_bar
from player.view.camera import Camera
from player.view.colors import ValueRange, format_number
from player.view.split_view import Pane
from player.view.state import Exporting, Scene
from traits.curves import TraitCurve

SIZE, AXIS, HANDLE = 14.0, 24.0, 13.0  # of letters; length of an axis; radius of the wipe's
PROGRESS_WIDTH = 270.0
PLOT, STRIP, BUTTON = 76.0, 96.0, 26.0  # heights: of the plot, of all that it takes, of its button
GAP, DOT = 14.0, 3.5  # between what is written and the plot; radius of its dots
DOT_ICON, BOTH_WAYS = "\uf111", "\uf337"  # icons


def draw_guides(pen: Pen, scene: Scene, values: ValueRange | None) -> None:
    """Scale bar and axes, and what the colours mean."""
    if scene.guides:
        draw_scale_bar(pen, scene.camera, scene.clip.unit)
        draw_axes(pen, scene.camera)
    if scene.legend and values is not None:
        draw_ramp(pen, values)
    elif scene.legend and scene.color_mode == "track":
        above_bar = pen.size[1] - pen.insets[1] - pen.insets[3] - 2 * LINE
        draw_organs(pen, scene.clip.track_table, above_bar)


def draw_axes(pen: Pen, camera: Camera) -> None:
    """The input's own axes, as the camera sees them; the farthest first."""
    left, _, _, bottom = pen.insets
    x, y = left + AXIS, pen.size[1] - bottom - AXIS
    seen = camera.view()[:3, :3]
    for axis in np.argsort(seen[2]):
        right, up = (AXIS * seen[:2, axis]).tolist()
        color = pen.theme.axes[axis]
        pen.sheet.add_line((x, y), (x + right, y - up), packed(color), 2.5)
        beyond = (x + 1.4 * right, y - 1.4 * up)
        pen.write(*beyond, "xyz"[axis], SIZE, color, bold=True, align=0.5)


def draw_organ(pen: Pen, organ: Track, facts: Sequence[tuple[str, str]]) -> None:
    """A card about the picked organ, on the left under the title."""
    with card("organ", pen.insets[:2], (0.0, 0.0), pen.size[0]):
        imgui.text_colored(rgb(organ.color), DOT_ICON)
        imgui.same_line()
        with imgui_ctx.push_font(pen.bold, 16.0):
            imgui.text_unformatted(one_line(organ.name, MAX_NAME))
        with imgui_ctx.begin_table("facts", 2, imgui.TableFlags_.sizing_fixed_fit):
            for what, value in facts:
                imgui.table_next_column()
                imgui.text_disabled(one_line(what, MAX_NAME))
                imgui.table_next_column()
                imgui.text_unformatted(one_line(value, MAX_NAME))


def draw_captions(pen: Pen, panes: Sequence[Pane], bottom: float) -> None:
    """The line between the panes, and what each of them shows, `bottom` above the edge."""
    (width, height), theme = pen.size, pen.theme
    for pane in panes[1:]:
        x, middle = pane.left * width, height / 2
        pen.sheet.add_line((x, 0.0), (x, height - bottom + 20.0), packed(theme.track), 2.0)
        if not pane.own:
            pen.sheet.add_circle_filled((x, middle), HANDLE, packed(theme.card))
            pen.write(x, middle, BOTH_WAYS, SIZE, theme.text, align=0.5)
    for number, pane in enumerate(panes):
        if pane.caption:
            place = (pane.left + pane.right) / 2 * width, height - bottom - 15.0
            with card(f"caption {number}", place, (0.5, 0.0), width):
                imgui.text_unformatted(one_line(pane.caption, MAX_NAME))


def draw_progress(pen: Pen, export: Exporting, bottom: float) -> None:
    """How far an export has come, in the middle above the timeline."""
    with card("export", (pen.size[0] / 2, pen.size[1] - bottom - 20.0), (0.5, 1.0), pen.size[0]):
        text = f"{one_line(export.name, MAX_NAME)}: E stops it"
        imgui.progress_bar(export.done / max(export.total, 1), (PROGRESS_WIDTH, 0.0), text)


def strip_height(scene: Scene) -> float:
    """What the plot takes of a window's height, in units; 0 where nothing is plotted."""
    return STRIP if scene.style.picked is not None and scene.curve else 0.0


def draw_curve(
    pen: Pen, scene: Scene, curves: Sequence[TraitCurve], line: Line, bottom: float
) -> Scene:
    """Draw the curve that the scene shows, with the band that the truth is likely in.

    line: the timeline's; bottom: the height where the strip ends.
    """
    curve = next((one for one in curves if one.trait == scene.curve), None)
    if curve is None:
        return scene
    theme, sheet = pen.theme, pen.sheet
    color = scene.clip.track_table[curve.track].color
    paint, left, top = packed(rgb(color)), line.left, bottom - PLOT
    x, now = [line.x_of(time) for time in curve.times], line.x_of(scene.timeline.day)
    y, high, low = (
        [bottom - PLOT * curve.level(value + side * margin) for value, margin in curve.points]
        for side in (0.0, 1.0, -1.0)
    )
    sheet.add_rect_filled((0.0, top - 10.0), pen.size, packed(faint(theme.veil, 0.75)))
    sheet.add_line((left, bottom), (line.right, bottom), packed(theme.track))
    for i, j in pairwise(range(len(x))):
        corners = (x[i], high[i]), (x[j], high[j]), (x[j], low[j]), (x[i], low[i])
        sheet.add_quad_filled(*corners, packed(rgb(color, 0.25)))
        sheet.add_line((x[i], y[i]), (x[j], y[j]), paint, 2.0)
    sheet.add_line((now, top), (now, bottom), packed(theme.accent))
    for i, sure in enumerate(curve.sure):
        sheet.add_circle_filled((x[i], y[i]), DOT, paint if sure else packed(theme.veil))
        sheet.add_circle((x[i], y[i]), DOT, paint, 0, 1.5)
    for value, height in ((curve.top, top + SIZE / 2), (curve.bottom, bottom - SIZE / 2)):
        text = format_number(value) + curve.unit
        pen.write(left - GAP, height, text, SIZE, theme.muted, align=1.0)
    with bare_window("curve", (0.0, top + 22.0), (left - GAP + 6.0, BUTTON)):
        name = curve.trait.capitalize()
        width = pen.width(name, 15.0) + 18.0
        imgui.set_cursor_pos((max(left - GAP + 6.0 - width, 0.0), 0.0))
        return button(scene, "curve", name, (width, BUTTON))
