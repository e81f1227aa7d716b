"""Which organ is under the cursor."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gclip.evaluate import layers_at, positions_on_curve
from player.view.camera import Camera

if TYPE_CHECKING:
    from gclip import Clip
    from player.view.split_view import Pane
    from player.view.style import Style

MOST = 400_000  # movers that are looked at; a fair sample of them where there are more
REACH = 10.0  # units from the cursor within which an organ counts as hit
LAYER = 0.04  # of the scene's radius: how far behind the nearest a mover is still beside it


def organ_under(
    clip: Clip,
    panes: Sequence[Pane],
    style: Style,
    at: tuple[float, float],
    size: tuple[float, float],
) -> tuple[bool, int | None]:
    """Whether a place in a window is over a pane of its first clip, and the organ seen there.

    at, size: the place from the top left corner, and the window's (width, height), in units.
    """
    width, height = size
    for pane in panes:
        left, right = pane.left * width, pane.right * width
        if pane.clip == 0 and left <= at[0] < right:
            whole = (right - left, height) if pane.own else size
            inside = (at[0] - (left if pane.own else 0.0), at[1])
            return True, organ_at(clip, pane.day, pane.camera, style, inside, whole)
    return False, None


def organ_at(
    clip: Clip,
    day: float,
    camera: Camera,
    style: Style,
    at: tuple[float, float],
    size: tuple[float, float],
) -> int | None:
    """The track of the organ that is seen at a place of the picture; None beside the plant.

    at, size: the place from the top left corner, and the picture's (width, height), in units.
    """
    positions, tracks = _movers(clip, day, style)
    if not len(tracks):
        return None
    matrix = camera.projection(size[0] / size[1]) @ camera.view()
    seen = positions @ matrix[:, :3].T + matrix[:, 3]
    depth = seen[:, 3]
    ahead = depth > 0.0
    shares = seen[:, :2] / np.where(ahead, depth, 1.0)[:, None]
    aside = (0.5 + 0.5 * shares[:, 0]) * size[0] - at[0]
    down = (0.5 - 0.5 * shares[:, 1]) * size[1] - at[1]
    apart = np.hypot(aside, down)
    hit = np.flatnonzero(ahead & (apart <= REACH))
    if not len(hit):
        return None
    # The nearest surface about the cursor, and on it the organ that comes closest to it.
    closest = hit[apart[hit] <= max(0.4 * REACH, float(apart[hit].min()) + 1.0)]
    front = float(depth[closest].min()) + LAYER * camera.radius
    on_top = closest[depth[closest] <= front]
    return int(tracks[on_top[np.argmin(apart[on_top])]])


def _movers(clip: Clip, day: float, style: Style) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) float64 positions and (n,) tracks of what is visible of the plant."""
    layers = [layer for layer in layers_at(clip, day) if not layer.litter]
    every = -(-sum(layer.group.count for layer in layers) // MOST) or 1
    positions, tracks = [np.zeros((0, 3))], [np.zeros(0, int)]
    for layer in layers:
        interval = clip.intervals[layer.interval]
        some = slice(layer.group.first, layer.group.stop, every)
        positions.append(positions_on_curve(interval, some, layer.parameter).astype(float))
        tracks.append(np.asarray(interval.tracks[some]).astype(int))
    found, names = np.concatenate(positions), np.concatenate(tracks)
    shown = ~np.isin(names, list(style.hidden))
    if style.alone is not None:
        shown &= names == style.alone
    return found[shown], names[shown]
