"""A trait or mean field of the picked organ over time, above the timeline and in step with it."""

from collections.abc import Sequence
from itertools import pairwise

from imgui_bundle import imgui

from player.ui.pen import Pen
from player.ui.theme import faint, packed, rgb
from player.ui.widgets import bare_window, button
from player.view.colors import format_number
from player.view.state import Scene
from traits.curves import TraitCurve

HEIGHT, STRIP, BUTTON = 76.0, 96.0, 26.0  # of the plot, of all that it takes, and of its button
GAP = 14.0  # between what is written and the plot
SIZE, DOT = 14.0, 3.5


def strip_height(scene: Scene) -> float:
    """What the plot takes of a window's height, in units; 0 where nothing is plotted."""
    return STRIP if scene.style.picked is not None and scene.curve else 0.0


def draw_curve(
    pen: Pen,
    scene: Scene,
    curves: Sequence[TraitCurve],
    ends: tuple[float, float],
    bottom: float,
) -> Scene:
    """Draw the curve that the scene shows, with the band that the truth is likely in.

    ends: where the timeline begins and ends; bottom: the height where the strip ends.
    """
    curve = next((one for one in curves if one.trait == scene.curve), None)
    if curve is None:
        return scene
    theme, sheet, clock = pen.theme, pen.sheet, scene.timeline
    color = scene.clip.track_table[curve.track].color
    paint, (left, right), top = packed(rgb(color)), ends, bottom - HEIGHT
    across = (right - left) / (clock.last - clock.first)
    x = [left + (time - clock.first) * across for time in curve.times]
    y, high, low = (
        [bottom - HEIGHT * curve.level(value + side * margin) for value, margin in curve.points]
        for side in (0.0, 1.0, -1.0)
    )
    ground = packed(faint(theme.veil, 0.75))
    sheet.add_rect_filled((0.0, top - 10.0), pen.size, ground)
    sheet.add_line((left, bottom), (right, bottom), packed(theme.track))
    for i, j in pairwise(range(len(x))):
        corners = (x[i], high[i]), (x[j], high[j]), (x[j], low[j]), (x[i], low[i])
        sheet.add_quad_filled(*corners, packed(rgb(color, 0.25)))
        sheet.add_line((x[i], y[i]), (x[j], y[j]), paint, 2.0)
    now = left + (clock.day - clock.first) * across
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
