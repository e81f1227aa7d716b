"""How a bake's cost grows with the scans: `python -m bench.scaling [--sizes 10000,100000,...]`.

For every size N a tree is grown, scanned twice with N points each, and baked by a process of its
own with default options. Printed are the processor time of all its threads, the wall clock, and the
peak of its memory; then the exponents between the sizes (1 is linear), start-up taken off, and
the memory for each point above that of the smallest size.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from itertools import pairwise
from math import log
from pathlib import Path

from grow.cli import main as grow

SIZES = (10_000, 100_000, 1_000_000, 3_000_000)
START_UP = 200  # points a scan: a bake of next to nothing


@dataclass(frozen=True)
class Cost:
    """Of one bake: points of both scans, seconds, megabytes."""

    points: int
    processor: float
    wall: float
    memory: float


def measure(points: int, workers: int) -> Cost:
    """Grow and bake a tree of two scans of `points` points."""
    with tempfile.TemporaryDirectory() as scratch:
        scans = Path(scratch) / "scans"
        grow(["tree", str(scans), "--scans", "2", "--points", str(points), "-q"])
        command = [sys.executable, "-m", "baker", str(scans), "-o", f"{scratch}/tree.gclip", "-q"]
        began = time.perf_counter()
        process = subprocess.Popen([*command, "--workers", str(workers)])
        _, status, usage = os.wait4(process.pid, 0)
        if status:
            raise SystemExit(f"the bake of {points} points failed")
        wall = time.perf_counter() - began
    # Linux counts kilobytes, macOS bytes.
    memory = usage.ru_maxrss / (1e6 if sys.platform == "darwin" else 1e3)
    return Cost(2 * points, usage.ru_utime + usage.ru_stime, wall, memory)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", default=",".join(map(str, SIZES)), help="points of each scan")
    parser.add_argument("--workers", type=int, default=0, help="as of bake; 0 takes all cores")
    arguments = parser.parse_args()
    start_up = measure(START_UP, arguments.workers)
    costs = []
    print(f"{'points':>12}{'processor':>12}{'wall':>10}{'memory':>11}")
    for size in map(int, arguments.sizes.split(",")):
        costs.append(measure(size, arguments.workers))
        found = costs[-1]
        print(
            f"{found.points:>12,}{found.processor:>10.1f} s{found.wall:>8.1f} s"
            f"{found.memory:>8.0f} MB",
            flush=True,
        )
    print(f"start-up: {start_up.processor:.1f} s, {start_up.memory:.0f} MB")
    for less, more in pairwise(costs):
        growth = log(more.points / less.points)
        times = (cost.processor - start_up.processor for cost in (more, less))
        bytes_each = (more.memory - start_up.memory) * 1e6 / more.points
        print(
            f"{less.points:,} to {more.points:,} points: time exponent "
            f"{log(next(times) / max(next(times), 1e-3)) / growth:.2f}, "
            f"{bytes_each:,.0f} bytes a point"
        )


if __name__ == "__main__":
    main()
