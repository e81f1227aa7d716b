"""What helps to read the picture in the window: guides, captions, the picked organ, an export."""

from collections.abc import Sequence

import numpy as np

from gclip import Clip, Track
from player.ui.pen import Pen
from player.ui.theme import packed, rgb
from player.view.annotations import draw_organs, draw_ramp, draw_scale_bar
from player.view.camera import Camera
from player.view.colors import ValueRange
from player.view.split_view import Pane
from player.view.state import Exporting, Scene

SIZE, ROW = 14.0, 22.0
AXIS = 24.0  # length of an axis
CARD_WIDTH, PROGRESS_WIDTH = 212.0, 300.0
HANDLE = 13.0  # radius of the wipe's


def draw_guides(pen: Pen, scene: Scene, clip: Clip, values: ValueRange | None) -> None:
    """Scale bar and axes, and what the colours mean."""
    if scene.guides:
        draw_scale_bar(pen, scene.camera, clip.unit)
        draw_axes(pen, scene.camera)
    if scene.legend and values is not None:
        draw_ramp(pen, values)
    elif scene.legend and scene.color_mode == "track":
        draw_organs(pen, clip.track_table)


def draw_axes(pen: Pen, camera: Camera) -> None:
    """The input's own axes, as the camera sees them; the farthest first."""
    left, _, _, bottom = pen.insets
    x, y = left + AXIS, pen.size[1] - bottom - AXIS
    seen = camera.view()[:3, :3]
    for axis in np.argsort(seen[2]):
        right, up = seen[:2, axis].tolist()
        tip, color = (x + AXIS * right, y - AXIS * up), pen.theme.axes[axis]
        pen.sheet.add_line((x, y), tip, packed(color), 2.5)
        beyond = (x + 1.4 * AXIS * right, y - 1.4 * AXIS * up)
        pen.write(*beyond, "xyz"[axis], SIZE, color, bold=True, align=0.5)


def draw_organ(pen: Pen, organ: Track, facts: Sequence[tuple[str, str]]) -> None:
    """A card about the picked organ, on the left under the title."""
    x, y = pen.insets[0], pen.insets[1]
    width = min(CARD_WIDTH, pen.size[0] - 2 * x)
    pen.panel(x, y, width, 54.0 + ROW * len(facts), 10.0)
    pen.sheet.add_circle_filled((x + 20.0, y + 22.0), 6.0, packed(rgb(organ.color)))
    title = pen.fitted(organ.name, 16.0, width - 50.0, bold=True)
    pen.write(x + 36.0, y + 22.0, title, 16.0, pen.theme.text, bold=True)
    for row, (what, value) in enumerate(facts):
        middle = y + 50.0 + ROW * row
        pen.write(x + 14.0, middle, what, SIZE, pen.theme.muted)
        text = pen.fitted(value, SIZE, width - 40.0 - pen.width(what, SIZE))
        pen.write(x + width - 14.0, middle, text, SIZE, pen.theme.text, align=1.0)


def draw_captions(pen: Pen, panes: Sequence[Pane], bottom: float) -> None:
    """The line between the panes, and what each of them shows, `bottom` above the edge."""
    (width, height), theme = pen.size, pen.theme
    for pane in panes[1:]:
        x, middle = pane.left * width, height / 2
        ends = (x, 0.0), (x, height - bottom + 20.0)
        pen.sheet.add_line(*ends, packed(theme.edge), 2.0)
        if not pane.own:
            pen.sheet.add_circle_filled((x, middle), HANDLE, packed(theme.card))
            pen.sheet.add_circle((x, middle), HANDLE, packed(theme.edge))
            pen.write(x, middle, "\uf337", SIZE, theme.text, align=0.5)
    for pane in panes:
        room = (pane.right - pane.left) * width - 24.0
        text = pen.fitted(pane.caption, SIZE, room)
        if not text or room < 40.0:
            continue
        pen.card((pane.left + pane.right) / 2 * width, height - bottom - 15.0, text, SIZE, room)


def draw_progress(pen: Pen, export: Exporting, bottom: float) -> None:
    """How far an export has come, in the middle above the timeline."""
    (width, height), theme = pen.size, pen.theme
    wide = min(PROGRESS_WIDTH, width - 2 * pen.insets[0])
    x, y, stop = (width - wide) / 2, height - bottom - 74.0, "E stops it"
    pen.panel(x, y, wide, 54.0, 10.0)
    text = pen.fitted(export.name, SIZE, wide - 44.0 - pen.width(stop, SIZE))
    pen.write(x + 14.0, y + 18.0, text, SIZE, theme.text)
    pen.write(x + wide - 14.0, y + 18.0, stop, SIZE, theme.muted, align=1.0)
    share = export.done / export.total if export.total else 0.0
    for part, paint in ((1.0, theme.track), (share, theme.accent)):
        left, right = x + 14.0, x + 14.0 + (wide - 28.0) * part
        pen.sheet.add_rect_filled((left, y + 35.0), (right, y + 41.0), packed(paint), 3.0)
