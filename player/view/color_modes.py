"""What movers can be coloured by: each mode is one entry of `ColorMode`.

The command line, the panel, legends, exports and pages follow from the entries. numpy is imported
when a mode is used, so that `play --help` is fast.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Self

import traits

if TYPE_CHECKING:
    from gclip import Clip

RANGE_QUANTILE = 0.98  # quantile of the values at which a colour map ends; outliers are clipped


@dataclass(frozen=True)
class Scale:
    """The range of a quantity in one clip, and its values or what the shaders need for them."""

    high: float  #: value of the last colour of the colour map
    unit: str
    low: float = 0.0  #: value of the first colour
    title: str = ""  #: name of the quantity, by default the label of its mode
    movers: Sequence[Any] = ()  #: for each interval (N,) values, or (N, 2) at its start and end
    organs: Callable[[float], Sequence[float]] = lambda day: ()  #: values of the organs on a day
    uniforms: Mapping[str, object] = field(default_factory=dict)  #: of the function in GLSL


@dataclass(frozen=True)
class Quantity:
    """What a colour map shows; without a map, movers have the colours of the scans or of organs.

    One of `per_mover`, `per_organ` and `glsl` says where the values are known.
    """

    colormap: str = ""  #: default colour map in `cmap`
    scale: Callable[["Clip", str], Scale] = lambda clip, field: Scale(1.0, "")
    per_mover: bool = False  #: whether movers have values at the scans, stored as their colours
    per_organ: bool = False  #: whether organs have values, which may change from day to day
    glsl: str = ""  #: function in shaders/scalar_field.glsl that computes the values of movers
    #: why a clip lacks the quantity, and how to bake it with the quantity; "" if it has it
    why_unavailable: Callable[["Clip"], str] = lambda clip: ""

    @property
    def changes_in_time(self) -> bool:
        """Whether a mover's colour changes between scans, which only pictures can show."""
        return self.per_organ or bool(self.glsl)


def _age(clip: "Clip", field: str) -> Scale:
    first, last = clip.times[0], clip.times[-1]
    born = [max(track.born, first) for track in clip.track_table]
    return Scale(last - first, clip.time_unit, organs=lambda day: [day - time for time in born])


def _growth(clip: "Clip", field: str) -> Scale:
    rates = traits.growth_rates(clip)
    return Scale(_high_end(rates), f"% a {clip.time_unit.removesuffix('s')}", movers=rates)


def _speed(clip: "Clip", field: str) -> Scale:
    unit = f"{clip.unit or 'units'} a {clip.time_unit.removesuffix('s')}"
    high = _high_end(traits.mean_speeds(clip))
    return Scale(high, unit, uniforms={"max_speed": high})


def _height(clip: "Clip", field: str) -> Scale:
    from player.view.camera import sampled_positions
    from traits.upright import upright_axes

    levels = sampled_positions(clip)[:, 2]
    lowest, highest = float(levels.min()), float(levels.max())
    high = max(highest - lowest, 1e-6, 1e-9 * abs(lowest))
    upward = (upright_axes(clip.up)[2] / high).tolist()
    uniforms = {"height_axis": (*upward, -lowest / high)}
    return Scale(high, clip.unit or "units", uniforms=uniforms)


def _field(clip: "Clip", field: str) -> Scale:
    import numpy as np

    index = clip.fields.index(field) if field in clip.fields else 0
    values = [interval.fields[index] for interval in clip.intervals]
    finite, quantiles = _finite(values), (1.0 - RANGE_QUANTILE, RANGE_QUANTILE)
    low, high = map(float, np.quantile(finite, quantiles)) if len(finite) else (0.0, 1.0)
    return Scale(max(high, low + 1e-9), "", low, clip.fields[index], movers=values)


def _error(clip: "Clip", field: str) -> Scale:
    errors, title = traits.holdout_errors(clip), "error against a scan left out"
    return Scale(_high_end(errors), clip.unit or "units", title=title, movers=errors)


def _finite(values: Sequence[Any]) -> Any:
    """All finite values of all intervals."""
    import numpy as np

    return np.concatenate([array[np.isfinite(array)] for array in values])


def _high_end(values: Sequence[Any]) -> float:
    """The quantile RANGE_QUANTILE of non-negative values, rounded up."""
    import numpy as np

    quantile = float(np.quantile(np.append(_finite(values), 0.0), RANGE_QUANTILE))
    return nice_ceil(max(quantile, 1e-9))


def nice_ceil(value: float) -> float:
    """Round up to 1, 1.5, 2, 3, 4, 5, 6 or 8 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(value))
    steps = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
    return next(step * power for step in steps if step * power >= value * (1 - 1e-9))


class ColorMode(StrEnum):
    """What movers are coloured by: name, label in the user interface, and quantity, if any."""

    label: str
    quantity: Quantity

    def __new__(cls, value: str, label: str = "", quantity: Quantity = Quantity()) -> Self:
        mode = str.__new__(cls, value)
        mode._value_, mode.label, mode.quantity = value, label, quantity
        return mode

    AUTO = "auto", "the scans' colours, or organs"
    SCAN = "scan", "scan colours"
    TRACK = "track", "organs"
    AGE = "age", "age", Quantity("crameri:imola_r", _age, per_organ=True)
    GROWTH = "growth", "growth rate", Quantity("colorbrewer:YlOrRd", _growth, per_mover=True)
    SPEED = "speed", "speed of motion", Quantity("colorbrewer:YlOrRd", _speed, glsl="speed_of")
    HEIGHT = "height", "height", Quantity("viridis", _height, glsl="height_of")
    FIELD = "field", "field of the scans", Quantity(
        "viridis", _field, per_mover=True, why_unavailable=lambda clip: "" if clip.fields else
        "the clip carries no field of its scans; bake it with --fields NAMES.",
    )  # fmt: skip
    ERROR = "error", "error", Quantity(
        "plasma", _error, per_mover=True, why_unavailable=lambda clip: "" if clip.held_out else
        "the clip holds no scan that was left out of it; bake it with --holdout 2.",
    )  # fmt: skip
