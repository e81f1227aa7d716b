"""Draws what helps to read the picture: scale bar, axes, legend, captions and the picked organ."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from player.ui.canvas import BOLD, Canvas, Color, color
from player.ui.layout import BAR, TOP, Layout

if TYPE_CHECKING:
    from gclip import Clip
    from player.ui.theme import Theme
    from player.view.camera import Camera
    from player.view.colors import ValueRange
    from player.view.split_view import Pane

SIZE, ROW = 14.0, 22.0
WIDEST_BAR = 0.18  # share of the width
AXIS = 24.0  # length of an axis
AXES = (color("#e5646a"), color("#67b567"), color("#5b8fe8"))
RAMP_WIDTH, RAMP_HEIGHT = 150.0, 10.0
CARD_WIDTH = 212.0
MOST_ORGANS = 12  # in a legend of organs: more are read in the panel
LEAST_ROOM = (560.0, 420.0)  # windows smaller than this show the plant and the timeline alone


def has_room(size: tuple[float, float]) -> bool:
    return size[0] >= LEAST_ROOM[0] - 40.0 and size[1] >= LEAST_ROOM[1]


def draw_scale_bar(
    canvas: Canvas, theme: Theme, layout: Layout, camera: Camera, unit: str, above: float = 0.0
) -> None:
    """True at the depth of the camera's target; `above` its usual place."""
    from player.view.annotations import round_length
    from player.view.colors import format_number

    width, height = layout.size
    units = height / (2.0 * camera.distance * math.tan(camera.field_of_view / 2))
    length = round_length(WIDEST_BAR * width / units)
    right, y = width - layout.margin, height - BAR + 12.0 - above
    left = right - length * units
    canvas.line((left, y), (right, y), theme.muted, 2.0)
    for x in (left, right):
        canvas.line((x, y - 4.0), (x, y + 4.0), theme.muted, 2.0)
    text = f"{format_number(length)} {unit or 'units'}"
    canvas.text((left + right) / 2, y - 14.0, text, SIZE, theme.muted, align=0.5)


def draw_axes(canvas: Canvas, theme: Theme, layout: Layout, camera: Camera) -> None:
    """The input's own axes, as the camera sees them; the farthest first."""
    x, y = layout.margin + AXIS, layout.size[1] - BAR - AXIS + 8.0
    seen = camera.view()[:3, :3]
    for axis in np.argsort(seen[2]):
        right, up, towards = seen[:, axis].tolist()
        tip = (x + AXIS * right, y - AXIS * up)
        paint = (*AXES[axis][:3], 0.55 + 0.45 * max(towards, 0.0))
        canvas.line((x, y), tip, paint, 2.5)
        beyond = 1.36
        place = (x + beyond * AXIS * right, y - beyond * AXIS * up)
        canvas.text(*place, "xyz"[axis], 13.0, paint, BOLD, align=0.5)


def draw_legend(
    canvas: Canvas, theme: Theme, layout: Layout, clip: Clip, scale: ValueRange | None, organs: bool
) -> None:
    """What the colours mean: a ramp, or the organs where they are few; below the title."""
    x, y = layout.margin, TOP + 8.0
    if scale is not None:
        canvas.text(x, y, scale.title, SIZE, theme.text)
        colors = [(*color, 1.0) for color in (scale.colors()[::15] / 255.0).tolist()]
        step = RAMP_WIDTH / (len(colors) - 1)
        for place, (left, right) in enumerate(pairwise(colors)):
            canvas.ramp(x + place * step, y + 14.0, step, RAMP_HEIGHT, left, right)
        low, high = scale.ends
        canvas.text(x, y + 36.0, low, SIZE, theme.muted)
        over = canvas.width(high, SIZE) > RAMP_WIDTH - 20.0
        canvas.text(
            x + (20.0 if over else RAMP_WIDTH), y + 36.0, high, SIZE, theme.muted,
            align=0.0 if over else 1.0,
        )  # fmt: skip
    elif organs and len(clip.track_table) <= MOST_ORGANS:
        for row, track in enumerate(clip.track_table):
            red, green, blue = (channel / 255.0 for channel in track.color)
            middle = y + row * ROW
            if middle + ROW + 2 * AXIS > layout.size[1] - BAR - 30.0:
                break
            canvas.disc(x + 6.0, middle, 5.0, (red, green, blue, 1.0))
            name = canvas.fitted(track.name, SIZE, 130.0)
            canvas.text(x + 20.0, middle, name, SIZE, theme.muted)


def draw_organ(
    canvas: Canvas,
    theme: Theme,
    layout: Layout,
    name: str,
    paint: Color,
    facts: Sequence[tuple[str, str]],
) -> None:
    """A card about the picked organ, on the right under the buttons."""
    width = min(CARD_WIDTH, layout.size[0] - 2 * layout.margin)
    height = 54.0 + ROW * len(facts)
    x, y = layout.size[0] - layout.margin - width, TOP - 4.0
    canvas.rectangle(x, y, width, height, theme.card, 10.0)
    canvas.frame(x, y, width, height, theme.edge, 10.0)
    canvas.disc(x + 20.0, y + 22.0, 6.0, paint)
    title = canvas.fitted(name, 16.0, width - 50.0, BOLD)
    canvas.text(x + 36.0, y + 22.0, title, 16.0, theme.text, BOLD)
    for row, (what, value) in enumerate(facts):
        middle = y + 50.0 + ROW * row
        canvas.text(x + 14.0, middle, what, SIZE, theme.muted)
        room = width - 40.0 - canvas.width(what, SIZE)
        text = canvas.fitted(value, SIZE, room)
        canvas.text(x + width - 14.0, middle, text, SIZE, theme.text, align=1.0)


def draw_panes(canvas: Canvas, theme: Theme, layout: Layout, panes: Sequence[Pane]) -> None:
    """The line between the panes, and what each of them shows."""
    width, height = layout.size
    for pane in panes[1:]:
        x = pane.left * width
        canvas.line((x, 0.0), (x, height - BAR + 20.0), theme.edge, 2.0)
        if layout.wipe is not None:
            middle = height / 2
            canvas.disc(x, middle, 13.0, theme.card)
            canvas.ring(x, middle, 13.0, theme.edge, 1.0)
            for side in (-1.0, 1.0):
                tip = x + 8.0 * side
                canvas.triangle(
                    [(tip, middle), (tip - 5.0 * side, middle - 4.5),
                     (tip - 5.0 * side, middle + 4.5)],
                    theme.text,
                )  # fmt: skip
    for index, pane in enumerate(panes):
        if not pane.caption:
            continue
        room = (pane.right - pane.left) * width - 24.0
        text = canvas.fitted(pane.caption, SIZE, room)
        if not text or room < 40.0:
            continue
        wide = canvas.width(text, SIZE) + 20.0
        middle = (pane.left + pane.right) / 2 * width
        left = min(max(middle - wide / 2, 8.0), width - wide - 8.0)
        left = min(left, pane.right * width - wide - 2.0) if index == 0 else max(left, 0.0)
        y = height - BAR - 2.0
        canvas.rectangle(left, y - 13.0, wide, 26.0, theme.card, 7.0)
        canvas.text(left + 10.0, y, text, SIZE, theme.text)


def draw_progress(
    canvas: Canvas, theme: Theme, layout: Layout, text: str, done: int, total: int
) -> None:
    """How far an export has come, in the middle above the timeline."""
    width = min(300.0, layout.size[0] - 2 * layout.margin)
    x, y = (layout.size[0] - width) / 2, layout.size[1] - BAR - 74.0
    canvas.rectangle(x, y, width, 54.0, theme.card, 10.0)
    canvas.frame(x, y, width, 54.0, theme.edge, 10.0)
    stop = "E stops it"
    room = width - 44.0 - canvas.width(stop, SIZE)
    canvas.text(x + 14.0, y + 18.0, canvas.fitted(text, SIZE, room), SIZE, theme.text)
    canvas.text(x + width - 14.0, y + 18.0, stop, SIZE, theme.muted, align=1.0)
    canvas.rectangle(x + 14.0, y + 35.0, width - 28.0, 6.0, theme.track, 3.0)
    share = done / total if total else 0.0
    if share > 0.0:
        canvas.rectangle(x + 14.0, y + 35.0, (width - 28.0) * share, 6.0, theme.accent, 3.0)
