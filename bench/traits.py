"""Traits against a grown plant's truth: `python -m bench.traits [KIND ...] [--seeds N]`.

`grow` plants are known at every instant. What `measure` says is compared with that

scan      on the scans themselves, as the clip holds them;
fresh     between the scans, of a scan taken on that very day: errors of the measure alone;
between   between the scans, of the clip: errors of the motion on top.

For organs of `--least` points and more, by how many they are, and for all whose trait is said to be
sure: how many organs, the median error, what nine in ten stay below, and how many stay below 5 %
(angles: 5 degrees). Of a branch with leaves the length is
that to the tip of its farthest leaf: a scan can't tell its last leaf from the others. `jump` is
the largest change, in %, of any organ's trait from just before a scan to it, or to just after.
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
from gclip import Clip, Motion, ScanMark, Track
from gclip.pack import Movers, pack_interval
from grow import plant
from grow.series import Plan, write_series
from traits import Measurement, measure

if TYPE_CHECKING:
    from grow.model import Cloud, Plant

TRAITS = ("length", "area", "hull", "height", "angle")
SHARES = (0.25, 0.5, 0.75)
BINS = (100, 200, 500, 1200, 10**9)
DENSE = 120_000  # points that show a hull
Error = tuple[Measurement, dict[str, float], str]


def truth(subject: Plant, day: float) -> dict[int, dict[str, float]]:
    """What is true of each organ on a day, by its label."""
    from scipy.spatial import ConvexHull

    dense = subject.cloud(day, DENSE, noise=0.0, colors=False)
    found = {}
    for organ in subject.organs(day):
        own = dense.points[dense.labels == organ.label].astype(float)
        line = _axis(subject, day, organ.label)
        passed = np.r_[0.0, np.linalg.norm(np.diff(line, axis=0), axis=1).cumsum()]
        start = [np.interp(passed[-1] / 4, passed, column) for column in line.T] - line[0]
        found[organ.label] = {
            "length": organ.reach,
            "area": organ.area,
            "hull": float(ConvexHull(own).volume) if len(own) > 20 else np.nan,
            "height": float(own[:, 2].max()) if len(own) else np.nan,
            "angle": float(np.degrees(np.arccos(start[2] / np.linalg.norm(start)))),
        }
    return found


def _axis(subject: Plant, day: float, label: int) -> np.ndarray:
    """(n, 3) the main axis of an organ."""
    body = subject._body
    first = int(np.flatnonzero(body.label == label)[0])
    return np.concatenate([body.pose(day).axis[part] for part in subject._main_axis(first)])


def clip_of(cloud: Cloud, day: float, subject: Plant) -> Clip:
    """A clip that stands still on one scan."""
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
        ScanMark(name, at, name, len(points)) for name, at in zip("ab", (day, day + 1), strict=True)
    )
    return Clip(scans=marks, intervals=(interval,), track_table=tracks)


def errors(
    found: Sequence[Measurement], clip: Clip, true: dict[int, dict[str, float]], least: int
) -> Iterator[Error]:
    for one in found:
        if one.track is None or one.points < least:
            continue
        name = clip.track_table[one.track].name
        label = 0 if name == "stem" else int(name.split()[-1])
        if label in true:
            yield one, {trait: _off(one, trait, true[label]) for trait in TRAITS}, name


def _off(one: Measurement, trait: str, true: dict[str, float]) -> float:
    value = getattr(one, trait)
    if value is None:
        return np.nan
    if trait == "angle":
        return value - true[trait]
    return 100.0 * (value / true[trait] - 1.0)


def jumps(clip: Clip, least: int) -> dict[str, float]:
    """The largest change of each trait from just before a scan to it and on, in %."""
    worst: dict[str, float] = defaultdict(float)
    for day in clip.times[1:-1]:
        step = 1e-6 * (clip.times[-1] - clip.times[0])
        three = [
            {one.track: one for one in measure(clip, when) if one.points >= least}
            for when in (day - step, day, day + step)
        ]
        for before, after in pairwise(three):
            for track in before.keys() & after.keys():
                for trait in TRAITS:
                    a, b = getattr(before[track], trait), getattr(after[track], trait)
                    if a and b:
                        change = abs(b - a) if trait == "angle" else 100.0 * abs(b / a - 1.0)
                        worst[trait] = max(worst[trait], change)
    return worst


def measure_errors(
    kind: str, seed: int, factor: float, least: int, verbose: bool
) -> dict[str, list]:
    subject = plant(kind, seed)
    points = tuple(round(factor * n) for n in subject._scan_points)
    with tempfile.TemporaryDirectory() as folder:
        scans = Path(folder) / "scans"
        write_series(Plan(kind, seed=seed, points=points), scans)
        clip = bake([scans], Options(align="none", up="z", labels="consistent", unit="mm"))
    rows: dict[str, list[Error]] = {"scan": [], "fresh": [], "between": []}

    def judge(state: str, of: Clip, day: float, true: dict) -> None:
        for error in errors(measure(of, day), of, true, least):
            rows[state].append(error)
            if verbose and max(abs(error[1][trait]) for trait in ("length", "area", "angle")) > 5:
                values = "  ".join(f"{trait} {value:+.1f}" for trait, value in error[1].items())
                print(f"  {state:8s} day {day:5.1f} {error[2]:9s} {error[0].points:5d}  {values}")

    for day in clip.times:
        judge("scan", clip, day, truth(subject, day))
    for interval in clip.intervals:
        for share in SHARES:
            day = interval.start + share * (interval.end - interval.start)
            true = truth(subject, day)
            count = round(factor * subject.default_points(day))
            fresh = clip_of(subject.cloud(day, count, seed=9, colors=False), day, subject)
            judge("fresh", fresh, day, true)
            judge("between", clip, day, true)
    worst = jumps(clip, least)
    print(
        f"{kind} {seed} x{factor:g}: jump "
        + ", ".join(f"{trait} {worst[trait]:.2f}" for trait in TRAITS)
    )
    return rows


def show(kind: str, rows: dict[str, list[Error]]) -> None:
    for state, all_of in rows.items():
        for low, high in pairwise(BINS):
            some = [row for row in all_of if low <= row[0].points < high]
            print(f"{kind:8s} {state:8s} {low:5d}..", *(_line(some, trait) for trait in TRAITS))
        sure = ([row for row in all_of if trait in row[0].sure] for trait in TRAITS)
        lines = (_line(some, trait) for some, trait in zip(sure, TRAITS, strict=True))
        print(f"{kind:8s} {state:8s} sure   ", *lines, flush=True)


def _line(rows: list[Error], trait: str) -> str:
    off = np.array([error[trait] for _, error, _ in rows])
    off = off[np.isfinite(off)]
    if not len(off):
        return f"| {trait}{'':28s}"
    size = np.abs(off)
    return (
        f"| {trait} {len(off):4d} {np.median(off):+5.1f} {np.median(size):5.1f}"
        f" {np.quantile(size, 0.9):5.1f} {100 * (size < 5).mean():4.0f}%"
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("kinds", nargs="*", default=["maize", "tomato", "tree"])
    parser.add_argument("--seeds", type=int, default=2, help="plants of each kind")
    parser.add_argument("--points", type=float, default=1.0, help="times the usual points")
    parser.add_argument("--least", type=int, default=100, help="points of an organ that counts")
    parser.add_argument("-v", "--verbose", action="store_true", help="name what is off by 5 %%")
    args = parser.parse_args()
    for kind in args.kinds:
        rows: dict[str, list[Error]] = {"scan": [], "fresh": [], "between": []}
        for seed in range(args.seeds):
            found = measure_errors(kind, seed, args.points, args.least, args.verbose)
            for state, some in found.items():
                rows[state] += some
        show(kind, rows)


if __name__ == "__main__":
    main()
