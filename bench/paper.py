"""The paper's Table 1, run again: `python -m bench.paper [ROW ...] [--runs N]`.

For every row a stand-in of the same size is grown and baked with `--paper` choices and with ours;
the plain numpy/scipy recipe (bench/recipe.py) runs on the same scans. Seconds of segmentation, and
of matching and transport; the paper's were taken on another machine. The last columns are of whole
processes: the recipe, from its start to the pairs on disk, on one thread; a `bake` with our
choices, from its start to the clip on disk; and how many times as long the recipe takes. A bake is
run twice, for while the recipe works the system may put the bake's libraries out of its memory, and
would read them from the disk. With `--runs` these take turns N times. The best of each counts:
other work can only take time.
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

ALIGNED = {"align": "none", "up": "z"}


@dataclass(frozen=True)
class Row:
    """One line of Table 1: who writes its scans, how they are baked, and the paper's seconds."""

    name: str
    write: Callable[[Path], None]
    options: dict
    paper_segmentation: str
    paper_transport: str


def maize(folder: Path) -> None:
    grow(["maize", str(folder), "--unlabelled", "-q"])


def cropped(folder: Path, backwards: bool = False) -> None:
    """A maize of 5,080 points, and the same without one leaf: 4,100 points."""
    from grow import plant

    cloud = plant("maize").cloud(14.0, points=60_000)
    labels = cloud.labels
    sizes = np.bincount(labels)
    leaf = int(np.argmin(np.abs(sizes[1:] / sizes.sum() - 980 / 5080))) + 1
    rng = np.random.default_rng(0)
    rest = rng.choice(np.flatnonzero(labels != leaf), 4100, replace=False)
    whole = np.r_[rest, rng.choice(np.flatnonzero(labels == leaf), 980, replace=False)]
    folder.mkdir()
    for day, kept in enumerate((whole, rest) if backwards else (rest, whole)):
        np.savetxt(folder / f"day{day}.txt", cloud.points[kept], fmt="%.4f")


def tree1(folder: Path) -> None:
    grow(["tree1", str(folder), "--unlabelled", "-q"])


def tree2(folder: Path) -> None:
    grow(["tree2", str(folder), "-q"])


def komatsuna(folder: Path) -> None:
    grow(["komatsuna", str(folder), "-q"])


THIN = {"labels": "ignore", **ALIGNED}
GIVEN = {"labels": "consistent", **ALIGNED}
ROWS = [
    Row("maize, 8 scans", maize, THIN, "12.1", "50"),
    Row("cropped maize, grows", cropped, THIN, "3", "6"),
    Row("cropped maize, falls", lambda f: cropped(f, backwards=True), THIN, "3", "6"),
    Row("synthetic tree 1", tree1, THIN, "4.2", "42"),
    Row("synthetic tree 2", tree2, GIVEN, "-", "88"),
    Row("komatsuna, 60 frames", komatsuna, GIVEN, "-", "105"),
    Row("komatsuna, every 10th", komatsuna, {**GIVEN, "every": 10}, "-", "8"),
]


def time_bake(folder: Path, options: Options) -> tuple[dict[str, float], int]:
    """Seconds of each stage of a bake, and the points baked."""
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
    """Seconds of a whole `bake`, from nothing to the clip on disk."""
    arguments = [f"--{name}={value}" for name, value in options.items()]
    command = [sys.executable, "-m", "baker", str(folder), "-q", *arguments]
    began = time.perf_counter()
    subprocess.run([*command, "-o", str(folder.parent / "plant.gclip"), "--force"], check=True)
    return time.perf_counter() - began


@dataclass(frozen=True)
class Plain:
    """Seconds of the recipe: of segmentation, of matching and transport, of the whole process."""

    segmentation: float
    transport: float
    whole: float


def time_recipe(folder: Path, options: dict) -> Plain:
    """The plain recipe on one thread, from nothing to the pairs on disk."""
    arguments = [f"--{name}={options[name]}" for name in ("labels", "every") if name in options]
    command = [sys.executable, "-m", "bench.recipe", str(folder), str(folder.parent / "pairs.npz")]
    alone = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL")}
    began = time.perf_counter()
    done = subprocess.run(
        [*command, *arguments], check=True, env={**os.environ, **alone}, capture_output=True
    )
    whole = time.perf_counter() - began
    segmentation, transport = map(float, done.stdout.split())
    return Plain(segmentation, transport, whole)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rows", nargs="*", help="parts of rows' names; all by default")
    parser.add_argument("--runs", type=int, default=1, help="of recipe and whole bake, best counts")
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
        plain, whole = min(recipes, key=lambda one: one.whole), min(bakes)
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
