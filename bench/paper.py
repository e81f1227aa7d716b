"""Times of the paper's Table 1: `python -m bench.paper [ROW ...] [--runs N]`.

For every row a plant of the same size is grown, and baked with `--paper` and with default options;
the plain numpy/scipy recipe (bench/recipe.py) runs on the same scans. Printed are the seconds of
segmentation, and of matching and transport; those of the paper were measured on another machine.

The last columns are of whole processes, from their start to the result on disk: the recipe on one
thread, `bake` with default options, and the ratio of these times. With `--runs`, both run in turns
N times, and the fastest run of each counts, since other load can only add time. Each turn bakes
twice, because the system may have evicted the libraries of `bake` from memory during the recipe.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from baker import Options, bake
from grow.cli import main as grow

ALIGNED = {"align": "none", "up": "z"}  # options for scans in common coordinates


@dataclass(frozen=True)
class Row:
    """A row of Table 1."""

    name: str
    write: Callable[[Path], None]  #: writes scans into a folder
    options: dict  #: of the bake
    paper_segmentation: str  #: seconds in the paper, "-" if there are none
    paper_transport: str  #: seconds of matching and transport in the paper


def write_maize(folder: Path) -> None:
    """Write scans of a maize plant."""
    grow(["maize", str(folder), "--unlabelled", "-q"])


def write_cropped(folder: Path, backwards: bool = False) -> None:
    """Write a maize plant without one leaf (4,100 points), and the whole plant (5,080 points).

    backwards: whether to write the whole plant first.
    """
    from grow import plant

    cloud = plant("maize").cloud(14.0, points=60_000)
    labels = cloud.labels
    sizes = np.bincount(labels)
    leaf = int(np.argmin(np.abs(sizes[1:] / sizes.sum() - 980 / 5080))) + 1
    rng = np.random.default_rng(0)
    cropped = rng.choice(np.flatnonzero(labels != leaf), 4100, replace=False)
    whole = np.r_[cropped, rng.choice(np.flatnonzero(labels == leaf), 980, replace=False)]
    folder.mkdir()
    for day, scan in enumerate((whole, cropped) if backwards else (cropped, whole)):
        np.savetxt(folder / f"day{day}.txt", cloud.points[scan], fmt="%.4f")


def write_tree1(folder: Path) -> None:
    """Write scans of the paper's synthetic tree 1."""
    grow(["tree1", str(folder), "--unlabelled", "-q"])


def write_tree2(folder: Path) -> None:
    """Write scans of the paper's synthetic tree 2, which have labels."""
    grow(["tree2", str(folder), "-q"])


def write_komatsuna(folder: Path) -> None:
    """Write scans of a komatsuna plant, which have labels."""
    grow(["komatsuna", str(folder), "-q"])


SEGMENTED = {"labels": "ignore", **ALIGNED}  # options for scans without labels
LABELLED = {"labels": "consistent", **ALIGNED}  # options for scans with labels
ROWS = [
    Row("maize, 8 scans", write_maize, SEGMENTED, "12.1", "50"),
    Row("cropped maize, grows", write_cropped, SEGMENTED, "3", "6"),
    Row("cropped maize, falls", lambda f: write_cropped(f, backwards=True), SEGMENTED, "3", "6"),
    Row("synthetic tree 1", write_tree1, SEGMENTED, "4.2", "42"),
    Row("synthetic tree 2", write_tree2, LABELLED, "-", "88"),
    Row("komatsuna, 60 frames", write_komatsuna, LABELLED, "-", "105"),
    Row("komatsuna, every 10th", write_komatsuna, {**LABELLED, "every": 10}, "-", "8"),
]


def time_bake(folder: Path, options: Options) -> tuple[dict[str, float], int]:
    """Bake in this process; returns the seconds of each stage, and the number of points."""
    seconds: dict[str, float] = {}
    stage, began = "", time.perf_counter()

    def progress(name: str, done: int, total: int) -> None:
        nonlocal stage, began
        if name != stage:
            now = time.perf_counter()
            seconds[stage] = seconds.get(stage, 0.0) + now - began
            stage, began = name, now

    clip = bake([folder], options, progress)
    seconds[stage] = seconds.get(stage, 0.0) + time.perf_counter() - began
    return seconds, sum(scan.points for scan in clip.scans)


def time_process(folder: Path, options: dict) -> float:
    """Seconds of a process of `bake`, from its start to the clip on disk."""
    arguments = [f"--{name}={value}" for name, value in options.items()]
    command = [sys.executable, "-m", "baker", str(folder), "-q", *arguments]
    began = time.perf_counter()
    subprocess.run([*command, "-o", str(folder.parent / "plant.gclip"), "--force"], check=True)
    return time.perf_counter() - began


@dataclass(frozen=True)
class RecipeTimes:
    """Seconds of the plain recipe."""

    segmentation: float
    transport: float  #: matching and transport
    whole: float  #: the whole process


def time_recipe(folder: Path, options: dict) -> RecipeTimes:
    """Run the plain recipe on one thread in a process of its own."""
    arguments = [f"--{name}={options[name]}" for name in ("labels", "every") if name in options]
    command = [sys.executable, "-m", "bench.recipe", str(folder), str(folder.parent / "pairs.npz")]
    one_thread = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL")}
    began = time.perf_counter()
    done = subprocess.run(
        [*command, *arguments], check=True, env={**os.environ, **one_thread}, capture_output=True
    )
    whole = time.perf_counter() - began
    segmentation, transport = map(float, done.stdout.split())
    return RecipeTimes(segmentation, transport, whole)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rows", nargs="*", help="parts of rows' names; all by default")
    parser.add_argument(
        "--runs", type=int, default=1, help="turns of recipe and bake, of which the fastest counts"
    )
    arguments = parser.parse_args()
    if arguments.runs < 1:
        parser.error(f"--runs is {arguments.runs}; it is 1 or more.")
    wanted = arguments.rows
    head = (
        "row",
        "points",
        "paper",
        "plain recipe",
        "--paper",
        "default",
        "whole recipe",
        "whole bake",
        "recipe / bake",
    )
    print(f"{head[0]:24}{head[1]:>9}" + "".join(f"{text:>15}" for text in head[2:]))
    for row in ROWS:
        if wanted and not any(part in row.name for part in wanted):
            continue
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch) / "scans"
            row.write(folder)
            recipes, bakes = [], []
            for _ in range(arguments.runs):
                recipes.append(time_recipe(folder, row.options))
                bakes += [time_process(folder, row.options) for _ in range(2)]
            paper, points = time_bake(folder, Options(paper=True, **row.options))
            ours, _ = time_bake(folder, Options(**row.options))
        plain, whole = min(recipes, key=lambda times: times.whole), min(bakes)
        cells = [
            f"{row.paper_segmentation} / {row.paper_transport}",
            f"{plain.segmentation:.1f} / {plain.transport:.1f}",
        ]
        cells += [
            f"{s['segmentation']:.1f} / {s['matching'] + s['transport']:.1f}" for s in (paper, ours)
        ]
        cells += [f"{plain.whole:.1f}", f"{whole:.1f}", f"{plain.whole / whole:.1f}"]
        print(f"{row.name:24}{points:>9,}" + "".join(f"{cell:>15}" for cell in cells), flush=True)
    print("seconds of segmentation / of matching and transport")


if __name__ == "__main__":
    main()
