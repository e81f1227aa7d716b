"""Scaling of `bake` with the number of points: `python -m bench.scaling [--sizes 10000,...]`.

For every size N a tree is grown, scanned twice with N points each, and baked with default options
in a process of its own. Printed are processor time of all threads, wall time and peak memory; and,
after subtraction of the start-up, the exponents of processor time between successive sizes (1 is
linear) and the memory per point.
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
START_UP = 200  # points per scan of a bake that measures start-up


@dataclass(frozen=True)
class Cost:
    """Cost of one bake."""

    points: int  #: of both scans
    processor: float  #: seconds of all threads
    wall: float  #: seconds
    memory: float  #: peak in megabytes


def measure(points: int, workers: int) -> Cost:
    """Grow and bake a tree with two scans of `points` points each."""
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
    # ru_maxrss is in kilobytes on Linux, and in bytes on macOS.
    memory = usage.ru_maxrss / (1e6 if sys.platform == "darwin" else 1e3)
    return Cost(2 * points, usage.ru_utime + usage.ru_stime, wall, memory)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", default=",".join(map(str, SIZES)), help="points of each scan")
    parser.add_argument("--workers", type=int, default=0, help="option of bake; 0 uses all cores")
    arguments = parser.parse_args()
    start_up = measure(START_UP, arguments.workers)
    costs = []
    print(f"{'points':>12}{'processor':>12}{'wall':>10}{'memory':>11}")
    for size in map(int, arguments.sizes.split(",")):
        costs.append(measure(size, arguments.workers))
        cost = costs[-1]
        print(
            f"{cost.points:>12,}{cost.processor:>10.1f} s{cost.wall:>8.1f} s{cost.memory:>8.0f} MB",
            flush=True,
        )
    print(f"start-up: {start_up.processor:.1f} s, {start_up.memory:.0f} MB")
    for less, more in pairwise(costs):
        growth = log(more.points / less.points)
        times = (cost.processor - start_up.processor for cost in (more, less))
        bytes_per_point = (more.memory - start_up.memory) * 1e6 / more.points
        print(
            f"{less.points:,} to {more.points:,} points: time exponent "
            f"{log(next(times) / max(next(times), 1e-3)) / growth:.2f}, "
            f"{bytes_per_point:,.0f} bytes a point"
        )


if __name__ == "__main__":
    main()
