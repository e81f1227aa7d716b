"""Errors of measured traits of grown plants: `python -m bench.traits [KIND ...] [--seeds N]`.

The shape of a plant of `grow` is known at every time. The results of `traits.measure` are compared
with it in three states:

scan      At the times of the scans, on the clip.
fresh     Between the scans, on another scan of that time: errors of the measurement alone.
between   Between the scans, on the clip: errors of the measurement and of the interpolation.

The table has rows for ranges of the number of points of organs, and for traits that are marked as
reliable (`Measurement.sure`). Its columns are the number of organs, the median error, the median
and the 90 % quantile of the absolute error, and the share of errors below 5 % (angles: 5 degrees).
The length of a branch with leaves includes its farthest leaf, since a scan does not show where the
branch ends. `jump` is the largest change of a trait of any organ, in %, from just before a scan to
that scan, or from it to just after.
"""

from __future__ import annotations

import argparse
import tempfile
from collections import defaultdict
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from baker import Options, bake
from baker.interpolation.packing import Movers, pack_interval
from gclip import Clip, Motion, ScanMark, Track
from grow import plant
from grow.series import Plan, write_series
from traits import Measurement, measure

if TYPE_CHECKING:
    from grow.model import Cloud, Plant

TRAITS = ("length", "area", "hull", "height", "angle")
SHARES = (0.25, 0.5, 0.75)  # of an interval, at which traits are measured between scans
BINS = (100, 200, 500, 1200, 10**9)  # bounds of the ranges of numbers of points
DENSE = 120_000  # points of a scan whose convex hulls are almost exact
Error = tuple[Measurement, dict[str, float], str]


def truth(subject: Plant, day: float) -> dict[int, dict[str, float]]:
    """True traits of organs on a day.

    Returns
    -------
    dict of int to dict
        Traits by name, for the label of each organ; lengths are in the plant's unit, angles in
        degrees.
    """
    from scipy.spatial import ConvexHull

    dense = subject.cloud(day, DENSE, noise=0.0, colors=False)
    traits = {}
    for organ in subject.organs(day):
        points = dense.points[dense.labels == organ.label].astype(float)
        axis = _axis(subject, day, organ.label)
        length = np.r_[0.0, np.linalg.norm(np.diff(axis, axis=0), axis=1).cumsum()]
        quarter = np.array([np.interp(length[-1] / 4, length, column) for column in axis.T])
        start = quarter - axis[0]
        traits[organ.label] = {
            "length": organ.reach,
            "area": organ.area,
            "hull": float(ConvexHull(points).volume) if len(points) > 20 else np.nan,
            "height": float(points[:, 2].max()) if len(points) else np.nan,
            "angle": float(np.degrees(np.arccos(start[2] / np.linalg.norm(start)))),
        }
    return traits


def _axis(subject: Plant, day: float, label: int) -> np.ndarray:
    """(N, 3) points along the main axis of an organ."""
    body = subject._body
    first = int(np.flatnonzero(body.label == label)[0])
    return np.concatenate([body.pose(day).axis[part] for part in subject._main_axis(first)])


def clip_of(cloud: Cloud, day: float, subject: Plant) -> Clip:
    """A clip of one interval in which a scan does not move."""
    points = cloud.points.astype(float)
    parents = {organ.label: organ.parent for organ in subject.organs(day)}
    tracks = tuple(
        Track(
            label,
            f"label {label}",
            (0, 0, 0),
            parent=None if not label else max(parents.get(label, 0), 0),
        )
        for label in range(int(cloud.labels.max()) + 1)
    )
    interval = pack_interval(
        day, day + 1.0, [Movers(Motion.MOVE, (points, points), cloud.labels)], spacing=1e-3
    )
    marks = tuple(
        ScanMark(name, time, name, len(points))
        for name, time in zip("ab", (day, day + 1), strict=True)
    )
    return Clip(scans=marks, intervals=(interval,), track_table=tracks)


def errors(
    measured: Sequence[Measurement],
    clip: Clip,
    true_traits: dict[int, dict[str, float]],
    min_points: int,
) -> Iterator[Error]:
    """Yield the errors of organs with enough points: the measurement, errors by trait, and name."""
    for organ in measured:
        if organ.track is None or organ.points < min_points:
            continue
        name = clip.track_table[organ.track].name
        label = 0 if name == "stem" else int(name.split()[-1])
        if label in true_traits:
            yield organ, {trait: _error(organ, trait, true_traits[label]) for trait in TRAITS}, name


def _error(organ: Measurement, trait: str, true_traits: dict[str, float]) -> float:
    """The error of a trait in percent, or of an angle in degrees; NaN if it was not measured."""
    value = getattr(organ, trait)
    if value is None:
        return np.nan
    if trait == "angle":
        return value - true_traits[trait]
    return 100.0 * (value / true_traits[trait] - 1.0)


def jumps(clip: Clip, min_points: int) -> dict[str, float]:
    """The largest change of each trait of an organ at a scan, in percent or degrees."""
    largest: dict[str, float] = defaultdict(float)
    for day in clip.times[1:-1]:
        step = 1e-6 * (clip.times[-1] - clip.times[0])
        measured = [
            {organ.track: organ for organ in measure(clip, time) if organ.points >= min_points}
            for time in (day - step, day, day + step)
        ]
        for before, after in pairwise(measured):
            for track in before.keys() & after.keys():
                for trait in TRAITS:
                    a, b = getattr(before[track], trait), getattr(after[track], trait)
                    if a and b:
                        change = abs(b - a) if trait == "angle" else 100.0 * abs(b / a - 1.0)
                        largest[trait] = max(largest[trait], change)
    return largest


def measure_errors(
    kind: str, seed: int, factor: float, min_points: int, verbose: bool
) -> dict[str, list[Error]]:
    """Bake a grown plant, measure it, and return the errors by state.

    factor: number of points of each scan relative to the default.
    """
    subject = plant(kind, seed)
    points = tuple(round(factor * n) for n in subject._scan_points)
    with tempfile.TemporaryDirectory() as folder:
        scans = Path(folder) / "scans"
        write_series(Plan(kind, seed=seed, points=points), scans)
        clip = bake([scans], Options(align="none", up="z", labels="consistent", unit="mm"))
    rows: dict[str, list[Error]] = {"scan": [], "fresh": [], "between": []}

    def compare(state: str, measured: Clip, day: float, true_traits: dict) -> None:
        for error in errors(measure(measured, day), measured, true_traits, min_points):
            rows[state].append(error)
            if verbose and max(abs(error[1][trait]) for trait in ("length", "area", "angle")) > 5:
                values = "  ".join(f"{trait} {value:+.1f}" for trait, value in error[1].items())
                print(f"  {state:8s} day {day:5.1f} {error[2]:9s} {error[0].points:5d}  {values}")

    for day in clip.times:
        compare("scan", clip, day, truth(subject, day))
    for interval in clip.intervals:
        for share in SHARES:
            day = interval.start + share * (interval.end - interval.start)
            true_traits = truth(subject, day)
            count = round(factor * subject.default_points(day))
            fresh = clip_of(subject.cloud(day, count, seed=9, colors=False), day, subject)
            compare("fresh", fresh, day, true_traits)
            compare("between", clip, day, true_traits)
    largest = jumps(clip, min_points)
    print(
        f"{kind} {seed} x{factor:g}: jump "
        + ", ".join(f"{trait} {largest[trait]:.2f}" for trait in TRAITS)
    )
    return rows


def show(kind: str, rows: dict[str, list[Error]]) -> None:
    """Print a row for each range of numbers of points, and one for reliable traits."""
    for state, errors_of_state in rows.items():
        for low, high in pairwise(BINS):
            binned = [row for row in errors_of_state if low <= row[0].points < high]
            print(f"{kind:8s} {state:8s} {low:5d}..", *(_cell(binned, trait) for trait in TRAITS))
        sure = ([row for row in errors_of_state if trait in row[0].sure] for trait in TRAITS)
        cells = (
            _cell(rows_of_trait, trait) for rows_of_trait, trait in zip(sure, TRAITS, strict=True)
        )
        print(f"{kind:8s} {state:8s} sure   ", *cells, flush=True)


def _cell(rows: list[Error], trait: str) -> str:
    """Format the statistics of a trait's errors."""
    signed = np.array([error[trait] for _, error, _ in rows])
    signed = signed[np.isfinite(signed)]
    if not len(signed):
        return f"| {trait}{'':28s}"
    absolute = np.abs(signed)
    return (
        f"| {trait} {len(signed):4d} {np.median(signed):+5.1f} {np.median(absolute):5.1f}"
        f" {np.quantile(absolute, 0.9):5.1f} {100 * (absolute < 5).mean():4.0f}%"
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("kinds", nargs="*", default=["maize", "tomato", "tree"])
    parser.add_argument("--seeds", type=int, default=2, help="plants of each kind")
    parser.add_argument(
        "--points", type=float, default=1.0, help="number of points, relative to the default"
    )
    parser.add_argument("--least", type=int, default=100, help="least number of points of an organ")
    parser.add_argument("-v", "--verbose", action="store_true", help="list errors above 5 %%")
    args = parser.parse_args()
    for kind in args.kinds:
        rows: dict[str, list[Error]] = {"scan": [], "fresh": [], "between": []}
        for seed in range(args.seeds):
            measured = measure_errors(kind, seed, args.points, args.least, args.verbose)
            for state, errors_of_state in measured.items():
                rows[state] += errors_of_state
        show(kind, rows)


if __name__ == "__main__":
    main()
