"""Curves of traits and mean fields of organs over time, with error margins, for plots."""

from __future__ import annotations

from collections.abc import Collection
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from html import escape
from itertools import chain
from os import cpu_count
from typing import TYPE_CHECKING

from traits.fields import field_means
from traits.table import NamedPlant
from traits.traits import measure

if TYPE_CHECKING:
    from gclip import Clip

PLOTTED = {"length": " {}", "area": " {}²", "angle": "°"}  # trait -> its unit, from that of lengths
FIELD = "mean {}"  # name of the curve of a field
# Relative errors that nine in ten values do not exceed, if they are sure and otherwise; those of
# angles are relative to 100 degrees (`python -m bench.traits`).
SURE_ERROR, UNSURE_ERROR = 0.05, 0.15
SVG_SIZE = (320.0, 84.0)  # width and height, in the units of the picture
STROKE = 'vector-effect="non-scaling-stroke"'  # of a stretched picture


@dataclass(frozen=True)
class TraitCurve:
    """One trait or mean field of one organ, at the scans with the organ."""

    track: int
    trait: str  #: one of `curve_names`
    unit: str
    times: tuple[float, ...]
    values: tuple[float, ...]
    margins: tuple[float, ...]  #: half the width of the error band
    sure: tuple[bool, ...]

    @property
    def bottom(self) -> float:
        """The lower end of a plot's axis: 0 for traits, the lowest value for fields."""
        return 0.0 if self.trait in PLOTTED else min(self.values)

    @property
    def top(self) -> float:
        """The highest value of the error band."""
        return max(map(sum, self.points))

    def level(self, value: float) -> float:
        """The position of a value between bottom and top, from 0 to 1."""
        return max(value - self.bottom, 0.0) / ((self.top - self.bottom) or 1.0)

    @property
    def points(self) -> list[tuple[float, float]]:
        """(value, margin) at each time."""
        return list(zip(self.values, self.margins, strict=True))


def curve_names(clip: Clip) -> list[str]:
    """Names of the curves of a clip: the traits, and the mean of each field."""
    return [*PLOTTED, *(FIELD.format(name) for name in clip.fields)]


def trait_curves(clip: Clip, tracks: Collection[int] | None = None) -> list[TraitCurve]:
    """Measure lengths, areas, angles and mean fields of organs at the scans.

    Parameters
    ----------
    clip : gclip.Clip
    tracks : collection of int, optional
        Ids of the organs; by default all.

    Returns
    -------
    list of TraitCurve
        Sorted by track id.
    """
    chosen = range(len(clip.track_table)) if tracks is None else tracks
    plant, unit = NamedPlant(clip, ""), clip.unit or "units"
    with ThreadPoolExecutor(cpu_count()) as threads:
        scans = list(threads.map(partial(measure, clip, only=chosen), clip.times))
    curves: dict[tuple[int, str], list[tuple[float, float, float, bool]]] = {}
    for organ in chain.from_iterable(scans):
        if organ.track is None:
            continue
        for trait in PLOTTED:
            value = getattr(organ, trait)
            if value is None:
                continue
            sure = plant.is_sure(organ, trait)
            margin = (100.0 if trait == "angle" else value) * (SURE_ERROR if sure else UNSURE_ERROR)
            curves.setdefault((organ.track, trait), []).append((organ.time, value, margin, sure))
        for name, mean in field_means(clip, organ.time, organ.track).items():
            point = (organ.time, mean, 0.0, not plant.is_doubtful(organ))
            curves.setdefault((organ.track, FIELD.format(name)), []).append(point)
    return [
        TraitCurve(track, trait, PLOTTED.get(trait, "").format(unit), *zip(*points, strict=True))
        for (track, trait), points in sorted(curves.items())
    ]


def curve_svg(curve: TraitCurve, span: tuple[float, float], color: str) -> str:
    """Draw a curve as an SVG element of 320 × 84 units.

    Parameters
    ----------
    curve : TraitCurve
    span : tuple of float
        First and last day of the x axis.
    color : str
        Of the line and the error band, in CSS notation.
    """
    (width, height), (first, last) = SVG_SIZE, span

    def position(time: float, value: float) -> str:
        x = width * (time - first) / (last - first)
        return f"{x:.1f},{height - 4.0 - (height - 8.0) * curve.level(value):.1f}"

    points = list(zip(curve.times, curve.values, curve.margins, strict=True))
    upper = [position(time, value + margin) for time, value, margin in points]
    lower = [position(time, value - margin) for time, value, margin in reversed(points)]
    line = [position(time, value) for time, value, _ in points]
    # Lines of length 0 with round caps, since circles would be stretched with the picture.
    dots = "".join(
        f'<path d="M{at}h0" stroke-width="7" opacity="{1.0 if sure else 0.4}" {STROKE}/>'
        for at, sure in zip(line, curve.sure, strict=True)
    )
    return (
        f'<svg viewBox="0 0 {width:g} {height:g}" overflow="visible" preserveAspectRatio="none">'
        f"<title>{escape(curve.trait)}</title>"
        f'<polygon points="{" ".join(upper + lower)}" fill="{color}" opacity="0.25"/>'
        f'<g stroke="{color}" fill="none" stroke-linecap="round">'
        f'<polyline points="{" ".join(line)}" stroke-width="2" {STROKE}/>'
        f"{dots}</g></svg>"
    )
