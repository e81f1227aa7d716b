"""Colours of movers by a style, for the window, its legend and every export.

Movers have the colours of the scans, of their organs, or of a value. Age is constant over an organ,
so it is drawn as another palette of tracks. Height and speed are computed in the shaders
(scalar_field.glsl), which look their colours up in a texture. Growth rates, fields and errors are
known for each mover at the scans: a copy of the clip stores them as its colours.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property, partial
from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from gclip import Clip, Interval
from gclip.evaluate import locate, palette_at, positions_on_curve, srgb_to_linear
from player.errors import PlayerError
from player.view.camera import sampled_positions
from player.view.style import ColorMap, ColorMode, Style
from traits.growth_rate import growth_rates
from traits.holdout_error import held_out_as_clip, holdout_errors
from traits.upright import upright_axes

Values = Sequence[NDArray[np.floating]]  # for each interval what `ValueRange.colored` takes

RAMP_SIZE = 256  # colours that a colour map is sampled at
MAX_SPEED_SAMPLES = 20_000  # movers of an interval from which the range of speeds is estimated
RANGE_QUANTILE = 0.98  # quantile of the values at which a colour map ends; outliers are clipped
DIMMED_SHARE = 0.12  # share of its own colour that an organ keeps beside a highlighted one
UNKNOWN_COLOR = np.array([150, 150, 150], np.uint8)  # sRGB of movers without a value
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # of linear sRGB (IEC 61966-2-1)


@dataclass(frozen=True)
class ValueRange:
    """A colour map and the range of values that it spans."""

    title: str  #: name of the quantity
    low: float  #: value of the first colour, in `unit`
    high: float  #: value of the last colour
    unit: str
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
        self._clip = clip
        self._values = cache(partial(range_and_values, clip))

    def value_range(self, style: Style) -> ValueRange | None:
        """The range for a colour bar; None if a style shows colours of scans or of organs.

        Raises PlayerError if the style shows a field or an error that the clip does not have.
        """
        return self._range_of(style) if style.color_mode(self._clip).colormap else None

    def clip_with_colors(self, style: Style, without_scans: bool = False) -> Clip:
        """The clip to draw: if a style colours by values of each mover, a copy with their colours.

        without_scans: whether to remove the colours of scans if the style shows organs, for files
                       with one colour per mover.

        Raises PlayerError as `value_range` does.
        """
        clip, mode = self._clip, style.color_mode(self._clip)
        if mode.per_mover:
            scale, (_, values) = self._range_of(style), self._values(mode, style.field)
            return replace(clip, intervals=tuple(map(scale.colored, clip.intervals, values)))
        if without_scans and mode is ColorMode.TRACK:
            bare = [replace(one, start_colors=None, end_colors=None) for one in clip.intervals]
            return replace(clip, intervals=tuple(bare))
        return clip

    def held_out_clip(self, index: int, style: Style) -> Clip:
        """A held-out scan as a clip that does not move, in the colours of a style."""
        clip, distances = held_out_as_clip(self._clip, index)
        if style.color_mode(self._clip) is not ColorMode.ERROR:
            return clip
        interval = self._range_of(style).colored(clip.intervals[0], distances)
        return replace(clip, intervals=(interval,))

    def scalar_field(self, style: Style) -> int:
        """The macro SCALAR_FIELD of scalar_field.glsl: 1 for height, 2 for speed, 0 otherwise."""
        return {ColorMode.HEIGHT: 1, ColorMode.SPEED: 2}.get(style.color_mode(self._clip), 0)

    def palette(self, day: float, style: Style) -> NDArray[np.float32]:
        """(tracks, 4) float32: colours of the organs in linear light, and their weights.

        The weight is 0 for hidden organs, 1 for visible ones, and in between for organs that are
        dimmed beside a highlighted one. The colours in the palette are dimmed already.
        """
        light = srgb_to_linear(self._track_colors(day, style) / 255.0)
        weight = np.ones(len(light))
        if style.picked is not None:
            weight[:] = DIMMED_SHARE
            weight[[style.picked if style.second is None else style.second, style.picked]] = 1.0
        grey = 0.35 * (light @ LUMINANCE)[:, None]
        light = weight[:, None] * light + (1.0 - weight[:, None]) * grey
        weight[[track for track in style.hidden if track < len(weight)]] = 0.0
        if style.isolated is not None:
            weight[np.arange(len(weight)) != style.isolated] = 0.0
        return np.column_stack([light, weight]).astype(np.float32)

    def ramp(self, style: Style) -> NDArray[np.float32]:
        """(RAMP_SIZE, 4) float32: the colour map in linear light for height and speed, else 0."""
        texels = np.zeros((RAMP_SIZE, 4), np.float32)
        if self.scalar_field(style):
            texels[:, :3] = srgb_to_linear(self._range_of(style).colors() / 255.0)
        return texels

    def uniforms(self, style: Style) -> dict[str, object]:
        """Uniforms by which scalar_field.glsl scales height and speed to values from 0 to 1."""
        high = self._range_of(style).high
        upward = upright_axes(self._clip.up)[2] / high
        return {"height_axis": (*upward.tolist(), -self._lowest / high), "max_speed": high}

    @cached_property
    def _lowest(self) -> float:
        return float(sampled_positions(self._clip)[:, 2].min())

    def _range_of(self, style: Style) -> ValueRange:
        """The range of a style whose colour mode has a colour map."""
        mode = style.color_mode(self._clip)
        if reason := mode.why_unavailable(self._clip):
            raise PlayerError(reason)
        values, _ = self._values(mode, style.field)
        name = mode.colormap if style.color_map == ColorMap.AUTO else style.color_map
        return replace(values, color_map=str(name))

    def _track_colors(self, day: float, style: Style) -> NDArray[np.uint8]:
        """(tracks, 3) uint8 sRGB colours of the organs, by age or their own."""
        if style.color_mode(self._clip) is not ColorMode.AGE:
            return palette_at(self._clip, *locate(self._clip, day))[:, :3]
        first = self._clip.times[0]
        born = np.array([max(track.born, first) for track in self._clip.track_table])
        return self._range_of(style).colors_of(day - born)


def range_and_values(clip: Clip, mode: ColorMode, field: str) -> tuple[ValueRange, Values]:
    """The range of a mode's values, and the values of each mover if they are stored in a clip.

    field: name of the field for `ColorMode.FIELD`; the clip's first field if it has no such one.
    """
    low, title, unit, time = 0.0, mode.label, clip.unit or "units", clip.time_unit.removesuffix("s")
    values: Values = []
    match mode:
        case ColorMode.AGE:
            high, unit = clip.times[-1] - clip.times[0], clip.time_unit
        case ColorMode.HEIGHT:
            levels = sampled_positions(clip)[:, 2]
            lowest, highest = float(levels.min()), float(levels.max())
            high = max(highest - lowest, 1e-6, 1e-9 * abs(lowest))
        case ColorMode.SPEED:
            high, unit = _high_end(_speeds(clip)), f"{unit} a {time}"
        case ColorMode.GROWTH:
            values, unit = growth_rates(clip), f"% a {time}"
            high = _high_end(values)
        case ColorMode.ERROR:
            values, title = holdout_errors(clip), f"{title} against a scan left out"
            high = _high_end(values)
        case ColorMode.FIELD:
            index = clip.fields.index(field) if field in clip.fields else 0
            values = [interval.fields[index] for interval in clip.intervals]
            title, unit, finite = clip.fields[index], "", _finite(values)
            quantiles = 1.0 - RANGE_QUANTILE, RANGE_QUANTILE
            low, high = np.quantile(finite, quantiles) if len(finite) else (0.0, 1.0)
            low, high = float(low), float(max(high, low + 1e-9))
        case ColorMode.AUTO | ColorMode.SCAN | ColorMode.TRACK:
            raise ValueError(f"{mode} has no values")
        case _:
            assert_never(mode)
    return ValueRange(title, low, high, unit, mode.colormap), values


def _speeds(clip: Clip) -> Values:
    """Mean speeds of some movers of each interval, in the clip's units of length and time."""
    speeds = []
    for interval in clip.intervals:
        count = sum(group.count for group in interval.groups if group.motion == "move")
        sample = slice(0, count, max(count // MAX_SPEED_SAMPLES, 1))
        start, end = (positions_on_curve(interval, sample, share) for share in (0.0, 1.0))
        distance = np.linalg.norm(end.astype(float) - start, axis=1)
        speeds.append(distance / (interval.end - interval.start))
    return speeds


def _finite(values: Values) -> NDArray[np.floating]:
    """All finite values of all intervals."""
    return np.concatenate([array[np.isfinite(array)] for array in values])


def _high_end(values: Values) -> float:
    """The quantile RANGE_QUANTILE of non-negative values, rounded up."""
    quantile = float(np.quantile(np.append(_finite(values), 0.0), RANGE_QUANTILE))
    return nice_ceil(max(quantile, 1e-9))


def format_number(value: float, digits: int = 3) -> str:
    """Format a number with so many significant digits and without an exponent: "2,510"."""
    return f"{float(f'{value:.{digits}g}'):,.12g}"


def nice_ceil(value: float) -> float:
    """Round up to 1, 1.5, 2, 3, 4, 5, 6 or 8 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(value))
    steps = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
    return float(next(step * power for step in steps if step * power >= value * (1 - 1e-9)))
