"""Throughput and memory of a cluster: `python -m bench.greenhouse [--plants 500] [--workers 2]`.

Grows small plants (three scans of about 300 points), starts a scheduler and workers as processes of
their own, and bakes all plants by `bake --cluster`. Prints the plants per second, the processor
time per plant, and the memory (RSS) of workers, scheduler and command after a tenth, a half and all
of the plants; then how that compares with `bake` and as many processes of its own. Fails if a clip
is missing or cannot be opened, or if a worker's memory grows by more than a tenth from the first to
the last of these points.
"""

from __future__ import annotations

import argparse
import os
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import numpy as np

import gclip
from baker import Options
from baker.scans.read import read_series
from baker.scans.scan import Series
from grow.series import Plan, write_series

KINDS = ("maize", "tomato", "tree")
DISTINCT = 9  # number of plants that are grown; the others are rotated copies
MARKS = (0.1, 0.5, 1.0)  # shares of the plants after which memory is measured
MAX_GROWTH = 1.1  # factor on a worker's memory between the first and the last mark


def grow_plants(house: Path, plants: int, scans: int, points: int) -> None:
    """Write scans of plants into folders below `house`.

    Parameters
    ----------
    house : Path
    plants, scans, points : int
        Number of plants, of scans of each plant, and of points of each scan.
    """
    grown: list[Series] = []
    for number in range(plants):
        kind = KINDS[number % len(KINDS)]
        folder = house / f"{kind}{number:05d}"
        if number < DISTINCT:
            write_series(Plan(kind, number, scans, points=(points, points)), folder)
            # A field that is named is read even where a plant has lost all organs but its stem.
            grown.append(read_series([folder], Options(label_field="label")))
            continue
        folder.mkdir()
        sine, cosine = np.sin(number), np.cos(number)
        rotation = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
        for scan in grown[number % DISTINCT].scans:
            table = np.column_stack([scan.points @ rotation.T, scan.labels])
            np.savetxt(folder / f"{Path(scan.name).stem}.txt", table, fmt="%.3f %.3f %.3f %d")


@contextmanager
def cluster(workers: int, folder: Path) -> Iterator[tuple[str, dict[str, int]]]:
    """Run a scheduler and workers; yields the address, and the process ids by name."""
    with socket.socket() as probe:  # finds a free port
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    commands = {"scheduler": ["dask_scheduler", "--host", "127.0.0.1", "--port", str(port)]}
    for number in range(workers):
        commands[f"worker {number}"] = ["dask_worker", address, "--nthreads", "1", "--no-nanny"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": folder}
    path = os.pathsep.join([os.getcwd(), os.environ.get("PYTHONPATH", "")])
    # The workers' profiler keeps call stacks of the last hour; memory would grow for an hour.
    profiler = {"DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED": "False"}
    environment = {**os.environ, **profiler, "OMP_NUM_THREADS": "1", "PYTHONPATH": path}
    processes = {}
    try:
        for name, (module, *arguments) in commands.items():
            run = [sys.executable, "-m", f"distributed.cli.{module}", *arguments, "--no-dashboard"]
            processes[name] = subprocess.Popen(run, env=environment, **quiet)
        yield address, {name: process.pid for name, process in processes.items()}
    finally:
        for process in reversed(processes.values()):
            process.terminate()
            process.wait()


def memory(pid: int) -> float:
    """Resident memory of a process in megabytes."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def processor_seconds(pid: int) -> float:
    """Processor time of a process so far, in seconds."""
    ticks = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[11:13]
    return sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--plants", type=int, default=500)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--scans", type=int, default=3)
    parser.add_argument("--points", type=int, default=300, help="of each scan")
    parser.add_argument(
        "--align", default="auto", help="option of bake; none is several times faster"
    )
    arguments = parser.parse_args()
    with ExitStack() as stack:
        scratch = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        house, clips = scratch / "house", scratch / "clips"
        grow_plants(house, arguments.plants, arguments.scans, arguments.points)
        address, pids = stack.enter_context(cluster(arguments.workers, scratch))
        command = [sys.executable, "-m", "baker", str(house), "-o", f"{clips}/", "-q"]
        command += ["--align", arguments.align]
        began = time.perf_counter()
        bake = subprocess.Popen([*command, "--cluster", address])
        pids["bake"] = bake.pid
        memories = watch(bake, clips, pids, arguments.plants)
        wall = time.perf_counter() - began
        if bake.wait():
            raise SystemExit("the bake failed")
        spent = {name: processor_seconds(pid) for name, pid in pids.items() if name != "bake"}
        baked = [gclip.open(path) for path in sorted(clips.iterdir())]
        per_plant = {name: seconds / len(baked) for name, seconds in spent.items()}
        scheduler = per_plant.pop("scheduler")
        print(
            f"{len(baked)} of {arguments.plants} plants in {wall:.1f} s, {len(baked) / wall:.2f} a "
            f"second; processor time per plant: workers {sum(per_plant.values()):.3f} s, scheduler "
            f"{scheduler:.4f} s"
        )
        if len(baked) != arguments.plants:
            raise SystemExit("plants were lost")
        command[command.index(f"{clips}/")] = f"{scratch / 'local'}/"
        began = time.perf_counter()
        subprocess.run([*command, "--workers", str(arguments.workers)], check=True)
        local = time.perf_counter() - began
        print(
            f"without a cluster {len(baked) / local:.2f} plants a second: dask has "
            f"{local / wall:.2f} of that"
        )
    first, last = memories[MARKS[0]], memories[MARKS[-1]]
    grown = [
        name
        for name in first
        if name.startswith("worker") and last[name] > MAX_GROWTH * first[name]
    ]
    if grown:
        raise SystemExit(f"memory grew: {', '.join(grown)}")


def watch(
    bake: subprocess.Popen, clips: Path, pids: dict[str, int], plants: int
) -> dict[float, dict[str, float]]:
    """Measure the memory of processes while plants are baked.

    Returns
    -------
    dict
        For each of MARKS the megabytes of each process by its name.
    """
    memories: dict[float, dict[str, float]] = {}
    for mark in MARKS:
        while bake.poll() is None and sum(1 for _ in clips.glob("*.gclip")) < mark * plants:
            time.sleep(0.05)
        if bake.poll() is None:
            memories[mark] = {name: memory(pid) for name, pid in pids.items()}
            sizes = (f"{name} {size:.0f} MB" for name, size in memories[mark].items())
            line = ", ".join(sizes)
            print(f"{mark:4.0%} done: {line}", flush=True)
    return memories


if __name__ == "__main__":
    main()
