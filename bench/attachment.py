"""Do organs stay on what bears them? `python -m bench.attachment SERIES [SERIES ...]`

A series is a folder of dayNN.txt (x y z label) or a grown plant and its seed, as `maize:0`. It is
baked with default options, in the frame that it is in. An organ's gap is the smallest distance
between its points and its parent's, of which the clip's table of tracks tells. Asked at 50 instants
of every interval, it should exceed the larger of the gaps at the two scans by no more than a point
spacing. What is lost and falls is no longer attached.

Each organ is a line: the interval and the instant at which it exceeds that gap most, and by how
much, in point spacings. `--brief` prints the worst of each series only.
"""

from __future__ import annotations

import argparse
import re
import shutil
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker import Options, bake
from grow.cli import main as grow

if TYPE_CHECKING:
    from gclip import Clip, Frame

INSTANTS, SAMPLED = 50, 100


@dataclass(frozen=True)
class Gap:
    """Of one organ in one interval: how much wider, in spacings, and where in the interval."""

    interval: int
    organ: int
    excess: float
    share: float


def gaps(clip: Clip) -> Iterator[Gap]:
    """The worst instant of each organ that has a parent, in each interval that shows both."""
    shares = np.linspace(0.0, 1.0, INSTANTS + 2)
    # At a scan's own time the next interval begins: this one's end is a moment before.
    shares[-1] = 1.0 - 1e-9
    for number, interval in enumerate(clip.intervals):
        found = [
            organ_gaps(clip, clip.at(interval.start + share * (interval.end - interval.start)))
            for share in shares
        ]
        lost = {pair.track for pair in interval.segments if pair.event == "loss"}
        for organ in (set(found[0]) & set(found[-1])) - lost:
            course = np.array([instant.get(organ, 0.0) for instant in found])
            worst = int(np.argmax(course[1:-1])) + 1
            excess = float(course[worst] - max(course[0], course[-1])) / clip.spacing
            yield Gap(number, organ, excess, float(shares[worst]))


def organ_gaps(clip: Clip, frame: Frame) -> dict[int, float]:
    """By organ: the smallest distance of its points from its parent's."""
    from scipy.spatial import cKDTree

    order = np.argsort(frame.tracks, kind="stable")
    tracks, first = np.unique(frame.tracks[order], return_index=True)
    points = dict(zip(tracks.tolist(), np.split(frame.local[order], first[1:]), strict=True))
    trees: dict[int, cKDTree] = {}
    found = {}
    for track in clip.track_table:
        if track.id not in points or track.parent not in points:
            continue
        if track.parent not in trees:
            trees[track.parent] = cKDTree(points[track.parent])
        found[track.id] = least_distance(trees[track.parent], points[track.id])
    return found


def least_distance(tree: object, points: NDArray[np.floating]) -> float:
    sample = points[:: max(1, len(points) // SAMPLED)]
    bound = float(tree.query(sample)[0].min())  # type: ignore[attr-defined]
    near = tree.query(points, distance_upper_bound=np.nextafter(bound, np.inf))[0]  # type: ignore[attr-defined]
    return min(bound, float(near.min()))


def prepared(series: str, folder: Path, args: argparse.Namespace) -> Path:
    """A folder with the scans of a series as they are asked for."""
    source, scans = Path(series), folder / "scans"
    scans.mkdir()
    if not source.is_dir():
        kind, _, seed = series.partition(":")
        source = folder / "grown"
        grow([kind, str(source), "--seed", seed or "0", "-q"])
        if not (args.every > 1 or args.backwards or args.points):
            return source
    files = [f for f in source.iterdir() if re.search(r"\d+(\.\d+)?\.(txt|ply|xyz)$", f.name)]
    files.sort(key=day_of)
    days = [day_of(f) for f in files]
    for file, day in list(zip(files, days, strict=True))[:: args.every]:
        shown = days[0] + days[-1] - day if args.backwards else day
        target = scans / f"day{shown:08.3f}{file.suffix}"
        if args.points and file.suffix == ".txt":
            rows = np.loadtxt(file)
            chosen = np.random.default_rng(0).permutation(len(rows))[: args.points]
            np.savetxt(target, rows[np.sort(chosen)], fmt="%.5f %.5f %.5f %d")
        else:
            shutil.copy(file, target)
    return scans


def day_of(file: Path) -> float:
    found = re.search(r"(\d+(?:\.\d+)?)\.[a-z]+$", file.name)
    return float(found.group(1)) if found else 0.0


def judged(series: str, args: argparse.Namespace) -> list[Gap]:
    labels = "ignore" if args.unlabelled else "auto"
    with tempfile.TemporaryDirectory() as folder:
        scans = prepared(series, Path(folder), args)
        clip = bake([scans], Options(align="none", labels=labels, paths=args.paths))
    worst: dict[int, Gap] = {}
    for gap in gaps(clip):
        if gap.organ not in worst or gap.excess > worst[gap.organ].excess:
            worst[gap.organ] = gap
    return sorted(worst.values(), key=lambda gap: -gap.excess)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("series", nargs="+")
    parser.add_argument("--unlabelled", action="store_true", help="ignore the labels")
    parser.add_argument("--paths", default="auto", help="as of `bake`")
    parser.add_argument("--every", type=int, default=1, help="bake every n-th scan only")
    parser.add_argument("--points", type=int, help="keep so many points of a scan")
    parser.add_argument("--backwards", action="store_true", help="the last scan first")
    parser.add_argument("--brief", action="store_true", help="the worst of each series only")
    args = parser.parse_args()
    print("series                  organ  excess  interval  share")
    for series in args.series:
        found = judged(series, args)
        for gap in found[:1] if args.brief else found:
            name = Path(series).name
            print(
                f"{name:22s} {gap.organ:6d} {gap.excess:7.2f} {gap.interval:9d} {gap.share:6.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
