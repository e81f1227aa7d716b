"""Colours of movers by a style, for the window, its legend and every export.

Movers have the colours of the scans, of their organs, or of a value (color_modes.py). Values of
organs are drawn as another palette of tracks. Those that the shaders compute (scalar_field.glsl)
are looked up in a texture. Those of movers at the scans are the colours of a copy of the clip.
"""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from gclip import Clip, Interval
from gclip.evaluate import locate, palette_at, srgb_to_linear
from player.errors import PlayerError
from player.view.color_modes import Scale
from player.view.style import ColorMap, ColorMode, Style
from shaders import GREY
from traits.holdout_error import held_out_as_clip

RAMP_SIZE = 256  # colours that a colour map is sampled at
DIMMED_SHARE = 0.12  # share of its own colour that an organ keeps beside a highlighted one
UNKNOWN_COLOR = np.array([150, 150, 150], np.uint8)  # sRGB of movers without a value


@dataclass(frozen=True, kw_only=True)
class ValueRange(Scale):
    """A scale with a colour map that spans it."""

    color_map: str  #: name of the colour map in `cmap`

    @property
    def ends(self) -> tuple[str, str]:
        """The lowest value, and the highest one with its unit, as text."""
        return format_number(self.low), f"{format_number(self.high)} {self.unit}".rstrip()

    def colors(self) -> NDArray[np.uint8]:
        """(RAMP_SIZE, 3) uint8 sRGB colours from low to high."""
        from cmap import Colormap

        ramp = np.asarray(Colormap(self.color_map)(np.linspace(0.0, 1.0, RAMP_SIZE)))
        return np.round(255.0 * ramp[:, :3]).astype(np.uint8)

    def colors_of(self, values: NDArray[np.floating]) -> NDArray[np.uint8]:
        """(N, 3) uint8 sRGB colours of (N,) values, clipped to the range; NaN is UNKNOWN_COLOR."""
        share = np.clip((values - self.low) / (self.high - self.low), 0.0, 1.0)
        indices = np.round((RAMP_SIZE - 1) * np.nan_to_num(share)).astype(int)
        return np.where(np.isnan(values)[:, None], UNKNOWN_COLOR, self.colors()[indices])

    def colored(self, interval: Interval, values: NDArray[np.floating]) -> Interval:
        """Copy an interval with the colours of values as its own.

        values: (N,) one for each mover, or (N, 2) at the interval's start and end.
        """
        ends = np.atleast_2d(values.T.astype(float))
        colors = [np.insert(self.colors_of(end), 3, 255, axis=1) for end in ends]
        return replace(interval, start_colors=colors[0], end_colors=colors[-1])


class Colors:
    """Computes colours of one clip for any style; values are cached by colour mode."""

    def __init__(self, clip: Clip) -> None:
        self.clip = clip
        self._scale = cache(lambda mode, field: mode.quantity.scale(clip, field))

    def value_range(self, style: Style) -> ValueRange | None:
        """The range for a colour bar; None if a style shows colours of scans or of organs.

        Raises PlayerError if the style shows a quantity that the clip does not have.
        """
        mode = style.color_mode(self.clip)
        if not mode.quantity.colormap:
            return None
        if reason := mode.quantity.why_unavailable(self.clip):
            raise PlayerError(reason)
        scale, chosen = self._scale(mode, style.field), style.color_map
        name = mode.quantity.colormap if chosen == ColorMap.AUTO else str(chosen)
        return ValueRange(**vars(scale) | {"title": scale.title or mode.label}, color_map=name)

    def clip_with_colors(self, style: Style, without_scans: bool = False) -> Clip:
        """The clip to draw: if a style colours by values of each mover, a copy with their colours.

        without_scans: whether to remove the colours of scans if the style shows organs, for files
                       with one colour per mover.

        Raises PlayerError as `value_range` does.
        """
        clip, mode = self.clip, style.color_mode(self.clip)
        if mode.quantity.per_mover and (scale := self.value_range(style)):
            return replace(clip, intervals=tuple(map(scale.colored, clip.intervals, scale.movers)))
        if without_scans and mode is ColorMode.TRACK:
            bare = [replace(one, start_colors=None, end_colors=None) for one in clip.intervals]
            return replace(clip, intervals=tuple(bare))
        return clip

    def held_out_clip(self, index: int, style: Style) -> Clip:
        """A held-out scan as a clip that does not move, in the colours of a style."""
        clip, distances = held_out_as_clip(self.clip, index)
        is_error = style.color_mode(self.clip) is ColorMode.ERROR
        if is_error and (scale := self.value_range(style)):
            return replace(clip, intervals=(scale.colored(clip.intervals[0], distances),))
        return clip

    def palette(self, day: float, style: Style) -> NDArray[np.float32]:
        """(tracks, 4) float32: colours of the organs in linear light, and their weights.

        The weight is 0 for hidden organs, 1 for visible ones, and in between for organs that are
        dimmed beside a highlighted one. The colours in the palette are dimmed already.
        """
        colors = palette_at(self.clip, *locate(self.clip, day))[:, :3]
        per_organ = style.color_mode(self.clip).quantity.per_organ
        if per_organ and (scale := self.value_range(style)):
            colors = scale.colors_of(np.array(scale.organs(day)))
        light = srgb_to_linear(colors / 255.0)
        weight = np.ones(len(light))
        if style.picked is not None:
            weight[:] = DIMMED_SHARE
            weight[[style.picked if style.second is None else style.second, style.picked]] = 1.0
        grey = (light @ GREY)[:, None]
        light = weight[:, None] * light + (1.0 - weight[:, None]) * grey
        weight[[track for track in style.hidden if track < len(weight)]] = 0.0
        if style.isolated is not None:
            weight[np.arange(len(weight)) != style.isolated] = 0.0
        return np.column_stack([light, weight]).astype(np.float32)


def format_number(value: float, digits: int = 3) -> str:
    """Format a number with so many significant digits and without an exponent: "2,510"."""
    return f"{float(f'{value:.{digits}g}'):,.12g}"
