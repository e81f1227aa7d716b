"""Evaluate a clip at a time, on the CPU; the shaders are tested against this module."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from operator import attrgetter
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gclip.schema import Group, Interval, Motion

if TYPE_CHECKING:
    from gclip.clip import Clip

LITTER_FADE = 0.15  # share of the following interval during which fallen organs fade


@dataclass(frozen=True)
class Layer:
    """A group of movers that is visible at a time, and how to render it."""

    interval: int
    group: Group
    parameter: float  #: u in [0, 1] of the Bézier curves, after easing
    blend: float  #: weight of the end's colour, in [0, 1]
    alpha: float  #: opacity in (0, 1]
    litter: bool = False  #: whether it has fallen to the ground


@dataclass(frozen=True)
class Frame:
    """The plant at one time."""

    day: float
    local: NDArray[np.float32]  #: (N, 3) positions relative to `origin`
    colors: NDArray[np.uint8]  #: (N, 4) sRGB and alpha
    tracks: NDArray[np.integer]  #: (N,) track ids
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    litter: Frame | None = None  #: fallen organs on the ground that have not faded yet
    fields: Mapping[str, NDArray[np.floating]] = field(default_factory=dict)
    """Name -> (N,) values of the clip's fields, NaN where unknown."""

    @property
    def positions(self) -> NDArray[np.float64]:
        """(N, 3) positions in the frame of the input."""
        return self.local + np.asarray(self.origin)

    def __len__(self) -> int:
        return len(self.local)

    def __repr__(self) -> str:
        return f"<gclip.Frame: day {self.day:g}, {len(self):,} points>"


def locate(clip: Clip, day: float) -> tuple[int, float]:
    """Find the interval of a time, and the share of it that has passed.

    The time of a scan is in the interval that starts there, that of the last scan in the last one.

    Parameters
    ----------
    clip : Clip
    day : float
        In the clip's unit of time.

    Returns
    -------
    interval : int
    share : float
        In [0, 1].
    """
    index = bisect_right([interval.start for interval in clip.intervals], day) - 1
    index = min(max(index, 0), len(clip.intervals) - 1)
    interval = clip.intervals[index]
    share = (day - interval.start) / (interval.end - interval.start)
    return index, min(max(share, 0.0), 1.0)


def layers_at(clip: Clip, day: float) -> list[Layer]:
    """The layers that are visible at a time: those of the plant, then those of the litter.

    Parameters
    ----------
    clip : Clip
    day : float
        In the clip's unit of time.
    """
    index, share = locate(clip, day)
    layers = []
    for group in clip.intervals[index].groups:
        if group.motion is Motion.MOVE or share == 0.0:
            layers.append(Layer(index, group, share, share, 1.0))
        elif group.motion is Motion.FALL:
            layers.append(Layer(index, group, share**2, share, 1.0, litter=share == 1.0))
        elif group.motion is Motion.FADE and share < 1.0:
            layers.append(Layer(index, group, share, share, 1.0 - share))
    if index > 0 and share < LITTER_FADE:
        fallen = [g for g in clip.intervals[index - 1].groups if g.motion is Motion.FALL]
        alpha = 1.0 - share / LITTER_FADE
        layers += [Layer(index - 1, g, 1.0, 1.0, alpha, litter=True) for g in fallen]
    return sorted(layers, key=attrgetter("litter"))


def bernstein(degree: int, parameter: float) -> NDArray[np.float64]:
    """Weights of the points of a Bézier curve: its Bernstein polynomials, which sum to 1.

    Parameters
    ----------
    degree : int
    parameter : float
        Of the curve, in [0, 1].

    Returns
    -------
    (degree + 1,) float64
    """
    d, u = degree, parameter
    return np.array([math.comb(d, i) * u**i * (1.0 - u) ** (d - i) for i in range(d + 1)])


def positions_on_curve(interval: Interval, movers: slice, parameter: float) -> NDArray[np.float32]:
    """Evaluate the curves of movers.

    Parameters
    ----------
    interval : Interval
    movers : slice
    parameter : float
        Of the curves, in [0, 1].

    Returns
    -------
    (n, 3) float32
        Positions relative to the clip's origin, in its unit.
    """
    weights = bernstein(interval.degree, parameter)
    blended = np.zeros((len(interval.tracks[movers]), 3), np.float64)
    for weight, points in zip(weights, interval.curve, strict=True):
        if weight:
            blended += weight * points[movers]
    if interval.box is not None:
        blended = np.asarray(interval.box.low) + interval.box.step * blended
    return blended.astype(np.float32)


def frame_at(clip: Clip, day: float) -> Frame:
    """Evaluate the clip at a time; see `Clip.at`."""
    layers = layers_at(clip, day)
    litter = [layer for layer in layers if layer.litter]
    plant = _frame(clip, day, [layer for layer in layers if not layer.litter])
    return replace(plant, litter=_frame(clip, day, litter)) if litter else plant


def _frame(clip: Clip, day: float, layers: list[Layer]) -> Frame:
    empty = (np.zeros((0, 3), np.float32), np.zeros((0, 4), np.uint8), np.zeros(0, np.uint16))
    parts = [empty, *(evaluate_layer(clip, layer) for layer in layers)]
    local, colors, tracks = map(np.concatenate, zip(*parts, strict=True))
    fields = {}
    for i, name in enumerate(clip.fields):
        blended = [_blend(clip.intervals[layer.interval].fields[i], layer) for layer in layers]
        fields[name] = np.concatenate([np.zeros(0, np.float32), *blended])
    return Frame(day, local, colors, tracks, clip.origin, fields=fields)


def _blend(values: NDArray[np.float32], layer: Layer) -> NDArray[np.floating]:
    """(n,) values of a layer's movers, blended between start and end."""
    start, end = values[layer.group.first : layer.group.stop].T
    mixed = (1.0 - layer.blend) * start + layer.blend * end
    # The values of the scans are exact, even if that of the other end is NaN.
    return {0.0: start, 1.0: end}.get(layer.blend, mixed)


def evaluate_layer(
    clip: Clip, layer: Layer
) -> tuple[NDArray[np.float32], NDArray[np.uint8], NDArray[np.integer]]:
    """Evaluate the movers of a layer.

    Parameters
    ----------
    clip : Clip
    layer : Layer

    Returns
    -------
    positions : (n, 3) float32
        Relative to the clip's origin, in its unit.
    colors : (n, 4) uint8
        sRGB and alpha.
    tracks : (n,) int
        The track of each mover.
    """
    interval = clip.intervals[layer.interval]
    movers = slice(layer.group.first, layer.group.stop)
    tracks = np.asarray(interval.tracks[movers])
    if interval.start_colors is not None and interval.end_colors is not None:
        colors = blend_srgb(interval.start_colors[movers], interval.end_colors[movers], layer.blend)
    else:
        colors = palette_at(clip, layer.interval, layer.blend)[tracks]
    colors[:, 3] = np.round(colors[:, 3] * layer.alpha)
    return positions_on_curve(interval, movers, layer.parameter), colors, tracks


def palette_at(clip: Clip, interval: int, share: float) -> NDArray[np.uint8]:
    """The colours of the tracks at a moment of an interval.

    The colour of an organ that is born changes from that of the organ it grows from to its own.

    Parameters
    ----------
    clip : Clip
    interval : int
    share : float
        Of the interval that has passed, in [0, 1].

    Returns
    -------
    (tracks, 4) uint8
        sRGB and alpha.
    """
    palette, ancestors = clip.palette, newborn(clip, interval)
    born, sources = list(ancestors), list(ancestors.values())
    palette[born] = blend_srgb(palette[sources], palette[born], share)
    return palette


def newborn(clip: Clip, interval: int) -> dict[int, int]:
    """Find the organs that are born in an interval.

    Parameters
    ----------
    clip : Clip
    interval : int

    Returns
    -------
    dict of int to int
        Track -> the older track that it grows from, by way of other new tracks or none.
    """
    start, end = clip.intervals[interval].start, clip.intervals[interval].end
    parents = {t.id: t.parent for t in clip.track_table if start < t.born <= end}
    ancestors = {}
    for track, parent in parents.items():
        visited = {track}  # a file may contain a cycle of parents
        while parent in parents and parent not in visited:
            visited.add(parent)
            parent = parents[parent]
        if parent is not None and parent not in parents:
            ancestors[track] = parent
    return ancestors


def srgb_to_linear(srgb: NDArray[np.floating]) -> NDArray[np.floating]:
    """Convert sRGB in [0, 1] to linear light in [0, 1]."""
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def linear_to_srgb(linear: NDArray[np.floating]) -> NDArray[np.floating]:
    """Convert linear light in [0, 1] to sRGB in [0, 1]."""
    curve = 1.055 * np.maximum(linear, 0.0) ** (1 / 2.4) - 0.055
    return np.where(linear <= 0.0031308, linear * 12.92, curve)


def blend_srgb(start: NDArray[np.uint8], end: NDArray[np.uint8], share: float) -> NDArray[np.uint8]:
    """Blend (N, 4) uint8 sRGB and alpha in linear light."""
    light = srgb_to_linear(np.arange(256) / 255.0)
    color = linear_to_srgb((1.0 - share) * light[start[:, :3]] + share * light[end[:, :3]])
    alpha = (1.0 - share) * start[:, 3:] + share * end[:, 3:]
    return np.hstack([np.round(255.0 * color), np.round(alpha)]).astype(np.uint8)
