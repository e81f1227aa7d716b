"""Errors of clips of grown plants: `python -m bench.truth [KIND ...] [--seeds N]`.

A plant of `grow` is scanned on its default days, and baked with `--paper` and with default options.
The clips are compared with the true shape of the plant between the scans:

error   Mean distance between clip and true surface, averaged over both directions and over a
        quarter, half and three quarters of every interval, minus the same distance of another scan
        with as many points; in % of the plant's size. RATIO is the error with default options
        divided by that with `--paper`.
length  Errors of lengths of organs at 20 times, in %, of those that are reliable
        (`Measurement.sure`) and contained in both scans: mean and 90 % quantile. In brackets, the
        same for another scan of that time, which is the error of the measurement.
area    The same for areas of organs.
falls   Largest decrease of the plant's height between two of 50 times, in % of the height.
gap     Largest distance between an organ and its parent at 50 times of each interval, minus that at
        the scans, in point spacings.
turn    Yaw between successive scans after alignment, if scans were rotated about the vertical axis
        and shifted at random: median and maximum, in degrees.
"""

from __future__ import annotations

import argparse
import tempfile
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from baker import Options, bake
from baker.alignment.register import align
from baker.scans.scan import Scan, Series
from bench.traits import clip_of, errors, truth
from grow import plant
from grow.cli import main as grow
from traits import measure

if TYPE_CHECKING:
    from gclip import Clip
    from grow.model import Plant

Cloud = NDArray[np.float32]
Errors = NDArray[np.float64]
TIMES = 50  # number of times of an interval, or of the series
SHARES = (0.25, 0.5, 0.75)  # of an interval, at which errors are measured
MAX_SHIFT = 0.1  # of scans in random poses, as a share of their height


def surface_distance(first: Cloud, second: Cloud) -> float:
    """The mean distance to the nearest point of the other cloud, averaged over both clouds."""
    from scipy.spatial import KDTree

    to_first, to_second = KDTree(first).query(second)[0], KDTree(second).query(first)[0]
    return float(to_first.mean() + to_second.mean()) / 2


def interpolation_error(clip: Clip, subject: Plant) -> float:
    """Mean error between the scans minus that of another scan, relative to the plant's size."""
    excess = []
    for interval in clip.intervals:
        for share in SHARES:
            day = interval.start + share * (interval.end - interval.start)
            rebuilt = np.unique(clip.at(day).positions, axis=0)
            count = round(
                (1 - share) * len(subject.cloud(interval.start))
                + share * len(subject.cloud(interval.end))
            )
            true_surface = subject.cloud(day, points=30_000, noise=0.0, colors=False).points
            other_scan = subject.cloud(day, points=count, seed=7, colors=False).points
            excess.append(
                surface_distance(rebuilt, true_surface) - surface_distance(other_scan, true_surface)
            )
    return float(np.mean(excess)) / plant_size(subject, clip.times[-1])


def plant_size(subject: Plant, day: float) -> float:
    """The longest side of the plant's bounding box."""
    return float(np.ptp(subject.cloud(day, colors=False).points, axis=0).max())


def trait_errors(clip: Clip, subject: Plant) -> dict[str, tuple[Errors, Errors]]:
    """Errors of lengths and areas of organs in %, of the clip and of other scans."""
    found: dict[str, tuple[list[float], list[float]]] = {t: ([], []) for t in ("length", "area")}
    for day in np.linspace(clip.times[0], clip.times[-1], 22)[1:-1]:
        interval = next(i for i in reversed(clip.intervals) if i.start <= day)
        matched = {pair.track for pair in interval.segments if pair.event == "match"}
        names = {track.name.split()[-1] for track in clip.track_table if track.id in matched}
        scan = subject.cloud(day, seed=9, colors=False)
        true_traits = truth(subject, day)
        for side, measured in enumerate((clip, clip_of(scan, day, subject))):
            organs = errors(measure(measured, day), measured, true_traits, min_points=1)
            for organ, error, name in organs:
                for trait in found:
                    if name.split()[-1] in names and trait in organ.sure:
                        found[trait][side].append(error[trait])
    return {
        trait: (np.array(clip_errors), np.array(fresh))
        for trait, (clip_errors, fresh) in found.items()
    }


def largest_fall(clip: Clip) -> float:
    """The largest decrease of height between successive times, relative to the largest height."""
    heights = [
        float(np.quantile(clip.at(day).positions[:, 2], 0.999))
        for day in np.linspace(clip.times[0], clip.times[-1], TIMES)
    ]
    return max(0.0, float(-np.diff(heights).min())) / max(heights)


def largest_gap(clip: Clip) -> float:
    """The largest distance of an organ to its parent minus that at the scans, in point spacings."""
    from scipy.spatial import KDTree

    largest = 0.0
    for interval in clip.intervals:
        step = (interval.end - interval.start) / TIMES
        days = np.linspace(interval.start + 1e-6 * step, interval.end - 1e-6 * step, TIMES)
        distances: dict[int, list[float]] = {}
        for day in days:
            frame = clip.at(day)
            for track in clip.track_table:
                if track.parent is None:
                    continue
                organ, parent = (frame.local[frame.tracks == t] for t in (track.id, track.parent))
                if len(organ) and len(parent):
                    nearest = float(KDTree(parent).query(organ)[0].min())
                    distances.setdefault(track.id, []).append(nearest)
        for series in distances.values():
            largest = max(largest, max(series) - max(series[0], series[-1]))
    return largest / clip.spacing


def yaw_errors(subject: Plant, seed: int) -> Errors:
    """Absolute yaw in degrees that alignment leaves between successive scans in random poses."""
    rng = np.random.default_rng(seed)
    scans, poses = [], []
    for day in subject.default_days:
        points = subject.cloud(float(day), colors=False).points
        pose = np.eye(4)
        pose[:3, :3] = Rotation.from_euler("z", rng.uniform(0, 360), degrees=True).as_matrix()
        pose[:3, 3] = rng.uniform(-MAX_SHIFT, MAX_SHIFT, 3) * np.ptp(points[:, 2])
        scans.append(Scan((points @ pose[:3, :3].T + pose[:3, 3]).astype(np.float32)))
        poses.append(pose)
    transforms = align(Series(tuple(scans)), up="z").transforms
    aligned = [
        (transform @ pose)[:3, :3] for transform, pose in zip(transforms, poses, strict=True)
    ]
    steps = [before.T @ after for before, after in pairwise(aligned)]
    return np.abs([Rotation.from_matrix(step).as_euler("zyx", degrees=True)[0] for step in steps])


def print_row(kind: str, seed: int) -> None:
    """Grow, bake and measure one plant, and print its errors."""
    subject = plant(kind, seed)
    with tempfile.TemporaryDirectory() as folder:
        scans = Path(folder) / "scans"
        grow([kind, str(scans), "--seed", str(seed), "-q"])
        fixed = {"align": "none", "up": "z", "labels": "consistent"}
        paper = interpolation_error(bake([scans], Options(paper=True, **fixed)), subject)
        clip = bake([scans], Options(**fixed))
    default = interpolation_error(clip, subject)
    measured, yaws = trait_errors(clip, subject), yaw_errors(subject, seed)
    fall, gap = largest_fall(clip), largest_gap(clip)
    print(
        f"{kind:8s} {seed:4d} {100 * paper:6.3f} {100 * default:6.3f} {default / paper:6.2f}",
        *(f"{_summary(ours)} ({_summary(fresh)})" for ours, fresh in measured.values()),
        f"{100 * fall:6.2f} {gap:6.2f} {np.median(yaws):5.2f} {yaws.max():6.2f}",
        flush=True,
    )


def _summary(errors: Errors) -> str:
    """Format mean and 90 % quantile of absolute errors."""
    if not len(errors):
        return "   -    -"
    return f"{np.abs(errors).mean():4.1f} {np.quantile(np.abs(errors), 0.9):4.1f}"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("kinds", nargs="*", default=["maize", "tomato", "tree"])
    parser.add_argument("--seeds", type=int, default=2, help="plants of each kind")
    args = parser.parse_args()
    print(
        "kind     seed  paper default RATIO"
        "   length  (fresh scan)    area   (fresh scan)  falls    gap        turn"
    )
    for kind in args.kinds:
        for seed in range(args.seeds):
            print_row(kind, seed)


if __name__ == "__main__":
    main()
