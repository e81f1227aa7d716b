"""In-between states against a grown plant's truth: `python -m bench.truth [KIND ...] [--seeds N]`.

`grow` plants are known at every instant. Each is scanned on its usual days, baked with `--paper`
and with our own choices, and what `Clip.at` says between the scans is compared with the plant:

error   Mean distance of the reconstruction to the true surface and back, at a quarter, half and
        three quarters of every interval, above that of another scan of the same size; in % of the
        plant's size. RATIO is ours over the paper's.
length  Error of the organs' lengths at 20 instants, in %, of those that `traits.measure` is sure
        of and that both scans hold: the mean, and below what nine in ten stay. In brackets the same
        of a fresh scan of that instant: what measuring itself is off by.
area    Likewise of the organs' areas.
falls   The largest loss of height from one of 50 instants to the next, in % of the height.
gap     By how much at most an organ's distance to its parent exceeds that at both scans, in point
        spacings, at 50 instants of each interval.
turn    Scans are turned about the vertical and shifted at random before they are aligned: the yaw
        that is left between successive scans, median and worst, in degrees.
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
from baker.alignment import align
from baker.scans import Scan, Series
from bench.traits import clip_of, truth
from bench.traits import errors as errors_of
from grow import plant
from grow.cli import main as grow
from traits import measure

if TYPE_CHECKING:
    from gclip import Clip
    from grow.model import Plant

Cloud = NDArray[np.float32]
Errors = NDArray[np.float64]
INSTANTS = 50
SHARES = (0.25, 0.5, 0.75)
SHIFT = 0.1  # of a scan's height


def distance(first: Cloud, second: Cloud) -> float:
    """The mean distance of two clouds, both ways, halved."""
    from scipy.spatial import cKDTree

    return (
        float(cKDTree(first).query(second)[0].mean() + cKDTree(second).query(first)[0].mean()) / 2
    )


def errors(clip: Clip, subject: Plant) -> float:
    """Mean error between the scans above the floor, as a share of the plant's size."""
    found = []
    for interval in clip.intervals:
        for share in SHARES:
            day = interval.start + share * (interval.end - interval.start)
            rebuilt = np.unique(clip.at(day).positions, axis=0)
            count = round(
                (1 - share) * len(subject.cloud(interval.start))
                + share * len(subject.cloud(interval.end))
            )
            truth = subject.cloud(day, points=30_000, noise=0.0, colors=False).points
            again = subject.cloud(day, points=count, seed=7, colors=False).points
            found.append(distance(rebuilt, truth) - distance(again, truth))
    return float(np.mean(found)) / size(subject, clip.times[-1])


def size(subject: Plant, day: float) -> float:
    return float(np.ptp(subject.cloud(day, colors=False).points, axis=0).max())


def organs_measured(clip: Clip, subject: Plant) -> dict[str, tuple[Errors, Errors]]:
    """Errors, in %, of organs' lengths and areas: of the clip's, and of fresh scans'."""
    found: dict[str, tuple[list[float], list[float]]] = {t: ([], []) for t in ("length", "area")}
    for day in np.linspace(clip.times[0], clip.times[-1], 22)[1:-1]:
        interval = next(i for i in reversed(clip.intervals) if i.start <= day)
        moved = {pair.track for pair in interval.segments if pair.event == "match"}
        held = {track.name.split()[-1] for track in clip.track_table if track.id in moved}
        scan = subject.cloud(day, seed=9, colors=False)
        true = truth(subject, day)
        for side, shown in enumerate((clip, clip_of(scan, day, subject))):
            for one, off, name in errors_of(measure(shown, day), shown, true, least=1):
                for trait in found:
                    if name.split()[-1] in held and trait in one.sure:
                        found[trait][side].append(off[trait])
    return {trait: (np.array(ours), np.array(fresh)) for trait, (ours, fresh) in found.items()}


def falls(clip: Clip) -> float:
    """The largest loss of height between instants, as a share of the final height."""
    heights = [
        float(np.quantile(clip.at(day).positions[:, 2], 0.999))
        for day in np.linspace(clip.times[0], clip.times[-1], INSTANTS)
    ]
    return max(0.0, float(-np.diff(heights).min())) / max(heights)


def gaps(clip: Clip) -> float:
    """How much farther than at the scans an organ's base gets from its parent, in spacings."""
    from scipy.spatial import cKDTree

    worst = 0.0
    for interval in clip.intervals:
        step = (interval.end - interval.start) / INSTANTS
        days = np.linspace(interval.start + 1e-6 * step, interval.end - 1e-6 * step, INSTANTS)
        spans: dict[int, list[float]] = {}
        for day in days:
            frame = clip.at(day)
            for track in clip.track_table:
                organ = frame.local[frame.tracks == track.id]
                parent = (
                    frame.local[frame.tracks == track.parent]
                    if track.parent is not None
                    else organ[:0]
                )
                if len(organ) and len(parent):
                    gap = float(cKDTree(parent).query(organ)[0].min())
                    spans.setdefault(track.id, []).append(gap)
        for gap_of in spans.values():
            worst = max(worst, max(gap_of) - max(gap_of[0], gap_of[-1]))
    return worst / clip.spacing


def turns(subject: Plant, seed: int) -> Errors:
    """Yaw in degrees that alignment leaves between scans that were turned and shifted at random."""
    rng = np.random.default_rng(seed)
    scans, poses = [], []
    for day in subject.default_days:
        points = subject.cloud(float(day), colors=False).points
        pose = np.eye(4)
        pose[:3, :3] = Rotation.from_euler("z", rng.uniform(0, 360), degrees=True).as_matrix()
        pose[:3, 3] = rng.uniform(-SHIFT, SHIFT, 3) * np.ptp(points[:, 2])
        scans.append(Scan((points @ pose[:3, :3].T + pose[:3, 3]).astype(np.float32)))
        poses.append(pose)
    found = align(Series(tuple(scans)), up="z").transforms
    placed = [(moved @ pose)[:3, :3] for moved, pose in zip(found, poses, strict=True)]
    steps = [before.T @ after for before, after in pairwise(placed)]
    return np.abs([Rotation.from_matrix(step).as_euler("zyx", degrees=True)[0] for step in steps])


def print_row(kind: str, seed: int) -> None:
    subject = plant(kind, seed)
    with tempfile.TemporaryDirectory() as folder:
        scans = Path(folder) / "scans"
        grow([kind, str(scans), "--seed", str(seed), "-q"])
        fixed = {"align": "none", "up": "z", "labels": "consistent"}
        paper = errors(bake([scans], Options(paper=True, **fixed)), subject)
        clip = bake([scans], Options(**fixed))
    ours = errors(clip, subject)
    measured, yaws = organs_measured(clip, subject), turns(subject, seed)
    print(
        f"{kind:8s} {seed:4d} {100 * paper:6.3f} {100 * ours:6.3f} {ours / paper:6.2f}",
        *(f"{_summary(ours)} ({_summary(fresh)})" for ours, fresh in measured.values()),
        f"{100 * falls(clip):6.2f} {gaps(clip):6.2f} {np.median(yaws):5.2f} {yaws.max():6.2f}",
        flush=True,
    )


def _summary(off: Errors) -> str:
    if not len(off):
        return "   -    -"
    return f"{np.abs(off).mean():4.1f} {np.quantile(np.abs(off), 0.9):4.1f}"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("kinds", nargs="*", default=["maize", "tomato", "tree"])
    parser.add_argument("--seeds", type=int, default=2, help="plants of each kind")
    args = parser.parse_args()
    print(
        "kind     seed  paper   ours  RATIO"
        "   length  (fresh scan)    area   (fresh scan)  falls    gap        turn"
    )
    for kind in args.kinds:
        for seed in range(args.seeds):
            print_row(kind, seed)


if __name__ == "__main__":
    main()
