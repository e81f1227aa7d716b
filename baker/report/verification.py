"""Verification by leaving scans out (paper section 4 and its Figure 13).

    clip, record = bake_recorded(["scans/"], Options(holdout=2))
    for error in verify(clip, record):
        print(error.name, error.rebuilt_to_real.mean)

The scans left out are aligned along with all others, and then play no part in the bake. At each
one's real time the clip is compared with it, both ways, with the whole series scaled to the unit
cube: the longest side of the box around all scans, those left out too, is 1.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import point_spacing
from baker.interpolation.keyframes import HeldOut
from baker.pipeline import BakeRecord
from gclip import Clip

if TYPE_CHECKING:
    from rich.console import Console


@dataclass(frozen=True)
class Distances:
    """From each point of one cloud to the nearest of another, in units of the unit cube."""

    mean: float
    deviation: float
    maximum: float


@dataclass(frozen=True)
class HoldoutError:
    """How far the clip is from a scan that it was baked without.

    name, date, time: of the scan left out; `points` how many it has.
    rebuilt_to_real:  of the clip's points at that time; low where nothing was made up.
    real_to_rebuilt:  of the scan's points; low where nothing is missing.
    spacing:          median distance between neighbouring points of the scan, in the unit cube:
                      errors below about half of it are only that both are samples of a surface.
    rebuilt:          (N, 3) float32, the clip's points at that time about the clip's origin.
    distances:        (N,) float64 of each rebuilt point to the scan, in the unit cube.
    """

    name: str
    date: str
    time: float
    points: int
    rebuilt_to_real: Distances
    real_to_rebuilt: Distances
    spacing: float
    rebuilt: NDArray[np.float32] = field(repr=False, compare=False)
    distances: NDArray[np.float64] = field(repr=False, compare=False)


def verify(
    clip: Clip, record: BakeRecord, progress: Callable[[str, int, int], None] | None = None
) -> list[HoldoutError]:
    """Compare a clip with the scans that were held out of it; none where none were.

    progress: called with "verification", the scans compared and the scans in all.
    """
    if not record.held_out:
        return []
    side, errors = unit_length(record), []
    for number, held in enumerate(record.held_out):
        if progress is not None:
            progress("verification", number, len(record.held_out))
        errors.append(_compare(clip, held, side))
    if progress is not None:
        progress("verification", len(errors), len(errors))
    return errors


def unit_length(record: BakeRecord) -> float:
    """The longest side of the box around all aligned scans, in their own unit; 1 if that is 0."""
    frames = [*record.keyframes, *(held.keyframe for held in record.held_out)]
    lows = [frame.positions.min(axis=0) for frame in frames]
    highs = [frame.positions.max(axis=0) for frame in frames]
    return float((np.max(highs, axis=0) - np.min(lows, axis=0)).max()) or 1.0


def _compare(clip: Clip, held: HeldOut, side: float) -> HoldoutError:
    from scipy.spatial import cKDTree

    real, rebuilt = held.keyframe.positions, clip.at(held.scan.time).local
    made = cKDTree(real).query(rebuilt)[0] / side
    missed = cKDTree(rebuilt).query(real)[0] / side
    return HoldoutError(
        name=held.scan.name,
        date=held.scan.date,
        time=held.scan.time,
        points=len(real),
        rebuilt_to_real=_distances(made),
        real_to_rebuilt=_distances(missed),
        spacing=point_spacing(real) / side,
        rebuilt=rebuilt,
        distances=made,
    )


def _distances(nearest: NDArray[np.float64]) -> Distances:
    return Distances(float(nearest.mean()), float(nearest.std()), float(nearest.max()))


def print_errors(console: Console, errors: list[HoldoutError]) -> None:
    """Print a table of the errors, two rows a scan left out, and of all together."""
    from rich.markup import escape
    from rich.table import Table

    table = Table(box=None, padding=(0, 2, 0, 0))
    for column in ("left out", "in the unit cube"):
        table.add_column(column, no_wrap=True)
    for figure in ("mean", "std", "max"):
        table.add_column(figure, justify="right", no_wrap=True)
    rows = [(f"{error.date}, {error.name}", both_ways(error)) for error in errors]
    rows += [("all", overall(errors))] if len(errors) > 1 else []
    for name, (made, missed) in rows:
        table.add_row(escape(name), "rebuilt to real", *_figures(made))
        table.add_row("", "real to rebuilt", *_figures(missed))
    console.print(table, highlight=False)


def both_ways(error: HoldoutError) -> tuple[Distances, Distances]:
    """Rebuilt to real, then real to rebuilt."""
    return error.rebuilt_to_real, error.real_to_rebuilt


def overall(errors: list[HoldoutError]) -> tuple[Distances, Distances]:
    """Mean of the means, mean of the deviations and largest of the maxima, both ways."""
    made, missed = (
        Distances(
            mean=float(np.mean([way.mean for way in ways])),
            deviation=float(np.mean([way.deviation for way in ways])),
            maximum=max(way.maximum for way in ways),
        )
        for ways in zip(*map(both_ways, errors), strict=True)
    )
    return made, missed


def _figures(way: Distances) -> tuple[str, str, str]:
    return f"{way.mean:.6f}", f"{way.deviation:.6f}", f"{way.maximum:.6f}"
