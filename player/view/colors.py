"""What colours mean: the one place that the window, its legend and every export ask.

A mover wears its scan's colours, its organ's, or the colour of a value: the organ's age, the
mover's height or speed, its growth rate or its error. Age is one value an organ, so it comes as
another palette of tracks; height and speed are found in the shaders (scalar_field.glsl), which read
their colours off a ramp; other values stand in a copy of the clip as its own colours.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property, partial

import numpy as np
from numpy.typing import NDArray

from gclip import Clip, Interval
from gclip.evaluate import locate, palette_at, positions_on_curve, srgb_to_linear
from player.errors import PlayerError
from player.view.camera import axes, outline
from player.view.holdout_error import held_out_as_clip, holdout_errors
from player.view.style import ColorMap, ColorMode, Style
from traits.growth_rate import growth_rates

Values = Sequence[NDArray[np.floating]]  # of each interval's movers, as `ValueRange.painted` has it

STEPS = 256  # texels of a ramp
SAMPLE = 20_000  # movers of an interval that the range of speeds is found from
FAST = 0.98  # share of the movers that are slower than the fastest colour says
BACK = 0.12  # how much of their own colour organs keep beside a highlighted one
UNKNOWN = np.array([150, 150, 150], np.uint8)  # sRGB of movers whose value is not known
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # of linear sRGB (IEC 61966-2-1)


@dataclass(frozen=True)
class ValueRange:
    """What the ends of a ramp stand for."""

    title: str  #: what the values are
    low: float  #: value at the ramp's first end, in `unit`
    high: float
    unit: str
    color_map: str  #: the colours, by a name in `cmap`

    @property
    def ends(self) -> tuple[str, str]:
        """The ends in words, lowest first; the unit stands with the highest."""
        return format_number(self.low), f"{format_number(self.high)} {self.unit}".rstrip()

    def colors(self) -> NDArray[np.uint8]:
        """(STEPS, 3) uint8 sRGB, from low to high."""
        from cmap import Colormap

        ramp = np.asarray(Colormap(self.color_map)(np.linspace(0.0, 1.0, STEPS)))
        return np.round(255.0 * ramp[:, :3]).astype(np.uint8)

    def colors_of(self, values: NDArray[np.floating]) -> NDArray[np.uint8]:
        """(N, 3) uint8 sRGB of values; those beyond an end have its colour, NaN is unknown."""
        share = np.clip((values - self.low) / (self.high - self.low), 0.0, 1.0)
        steps = np.round((STEPS - 1) * np.nan_to_num(share)).astype(int)
        return np.where(np.isnan(values)[:, None], UNKNOWN, self.colors()[steps])

    def painted(self, interval: Interval, values: NDArray[np.floating]) -> Interval:
        """A copy of an interval that wears its movers' values, (N, 2) at its start and at its end
        or (N,) for both, as colours.
        """
        ends = np.atleast_2d(values.T.astype(float))
        colors = [np.insert(self.colors_of(end), 3, 255, axis=1) for end in ends]
        return replace(interval, start_colors=colors[0], end_colors=colors[-1])


class Colors:
    """Of one clip."""

    def __init__(self, clip: Clip) -> None:
        self._clip = clip
        self._values = cache(partial(values_of, clip))

    def color_scale(self, style: Style) -> ValueRange | None:
        """What to explain in a legend; None for the scans' and the organs' own colours.

        Raises PlayerError for fields and errors where the clip holds none.
        """
        return self._scale(style) if style.color_mode(self._clip).colormap else None

    def clip_with_colors(self, style: Style, as_file: bool = False) -> Clip:
        """The clip to draw: a copy with values as colours where a style shows such.

        as_file: to write into files that hold one colour a mover: then without the scans' colours
                 where a style shows the organs'.
        Raises PlayerError as `color_scale` does, and for files of values that change while the
        plant grows.
        """
        clip, mode = self._clip, style.color_mode(self._clip)
        if mode.painted:
            scale, (_, values) = self._scale(style), self._values(mode, style.field)
            pairs = zip(clip.intervals, values, strict=True)
            return replace(clip, intervals=tuple(scale.painted(*pair) for pair in pairs))
        if as_file and mode.colormap:
            raise PlayerError(
                f"--color {mode} changes while the plant grows: it is for pictures and films; "
                "point files take scan, track or error."
            )
        if as_file and mode is ColorMode.TRACK:
            bare = [replace(one, start_colors=None, end_colors=None) for one in clip.intervals]
            return replace(clip, intervals=tuple(bare))
        return clip

    def left_out(self, number: int, style: Style) -> Clip:
        """A scan that was left out, as a clip that wears a style's colours."""
        clip, missed = held_out_as_clip(self._clip, number)
        if style.color_mode(self._clip) is not ColorMode.ERROR:
            return clip
        return replace(clip, intervals=(self._scale(style).painted(clip.intervals[0], missed),))

    def scalar_field(self, style: Style) -> int:
        """What scalar_field.glsl finds a value of, by its number there; 0 for nothing."""
        return {ColorMode.HEIGHT: 1, ColorMode.SPEED: 2}.get(style.color_mode(self._clip), 0)

    def palette(self, day: float, style: Style) -> NDArray[np.float32]:
        """(tracks, 4) float32: linear light, and what is left of a mover's own colour.

        The fourth number is 0 for hidden organs, 1 for most; between them for those that stand
        back behind a highlighted one. Organs' colours have that taken into account already.
        """
        light = srgb_to_linear(self._track_colors(day, style) / 255.0)
        kept = np.ones(len(light))
        if style.picked is not None:
            kept[:] = BACK
            kept[[style.picked if style.second is None else style.second, style.picked]] = 1.0
        grey = 0.35 * (light @ LUMINANCE)[:, None]
        light = kept[:, None] * light + (1.0 - kept[:, None]) * grey
        kept[[track for track in style.hidden if track < len(kept)]] = 0.0
        if style.alone is not None:
            kept[np.arange(len(kept)) != style.alone] = 0.0
        return np.column_stack([light, kept]).astype(np.float32)

    def ramp(self, style: Style) -> NDArray[np.float32]:
        """(STEPS, 4) float32 linear light of values from 0 to 1; black where there are none."""
        texels = np.zeros((STEPS, 4), np.float32)
        if self.scalar_field(style):
            texels[:, :3] = srgb_to_linear(self._scale(style).colors() / 255.0)
        return texels

    def uniforms(self, style: Style) -> dict[str, object]:
        """How scalar_field.glsl gets from positions and velocities to values from 0 to 1."""
        high = self._scale(style).high
        upward = axes(self._clip.up)[2] / high
        return {"height_axis": (*upward.tolist(), -self._lowest / high), "max_speed": high}

    @cached_property
    def _lowest(self) -> float:
        return float(outline(self._clip)[:, 2].min())

    def _scale(self, style: Style) -> ValueRange:
        """Of a mode that has a colour map."""
        mode = style.color_mode(self._clip)
        if lacking := mode.lacking(self._clip):
            raise PlayerError(lacking)
        scale, _ = self._values(mode, style.field)
        map = mode.colormap if style.color_map == ColorMap.AUTO else style.color_map
        return replace(scale, color_map=str(map))

    def _track_colors(self, day: float, style: Style) -> NDArray[np.uint8]:
        """(tracks, 3) uint8 sRGB."""
        if style.color_mode(self._clip) is not ColorMode.AGE:
            return palette_at(self._clip, *locate(self._clip, day))[:, :3]
        first = self._clip.times[0]
        born = np.array([max(track.born, first) for track in self._clip.track_table])
        return self._scale(style).colors_of(day - born)


def values_of(clip: Clip, mode: ColorMode, field: str) -> tuple[ValueRange, Values]:
    """What the ends of a mode's ramp stand for, and the values of the movers that are painted."""
    low, title, unit, time = 0.0, mode.label, clip.unit or "units", clip.time_unit.removesuffix("s")
    values: Values = []
    match mode:
        case ColorMode.AGE:
            high, unit = clip.times[-1] - clip.times[0], clip.time_unit
        case ColorMode.HEIGHT:
            levels = outline(clip)[:, 2]
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
        case _:
            index = clip.fields.index(field) if field in clip.fields else 0
            values = [interval.fields[index] for interval in clip.intervals]
            title, unit, known = clip.fields[index], "", _known(values)
            low, high = np.quantile(known, [1.0 - FAST, FAST]) if len(known) else (0.0, 1.0)
            low, high = float(low), float(max(high, low + 1e-9))
    return ValueRange(title, low, high, unit, mode.colormap), values


def _speeds(clip: Clip) -> Values:
    """Of some movers of each interval, in the clip's units."""
    speeds = []
    for interval in clip.intervals:
        count = sum(group.count for group in interval.groups if group.motion == "move")
        some = slice(0, count, max(count // SAMPLE, 1))
        start, end = (positions_on_curve(interval, some, share) for share in (0.0, 1.0))
        distance = np.linalg.norm(end.astype(float) - start, axis=1)
        speeds.append(distance / (interval.end - interval.start))
    return speeds


def _known(values: Values) -> NDArray[np.floating]:
    """Those of all intervals that are numbers."""
    return np.concatenate([one[np.isfinite(one)] for one in values])


def _high_end(values: Values) -> float:
    """A round value that few exceed."""
    return nice_ceil(max(float(np.quantile(np.append(_known(values), 0.0), FAST)), 1e-9))


def format_number(value: float) -> str:
    """Three digits of it, as people write them: 2,510 and no 2.51e+03."""
    return f"{float(f'{value:.3g}'):,.12g}"


def nice_ceil(value: float) -> float:
    """The next number that people like to read on a scale: 1, 1.5, 2, 3, 4, 5, 6, 8 times 10^n."""
    power = 10.0 ** np.floor(np.log10(value))
    steps = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
    return float(next(step * power for step in steps if step * power >= value * (1 - 1e-9)))
