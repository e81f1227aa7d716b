"""Many small plants through a cluster: `python -m bench.greenhouse [--plants 500] [--workers 2]`.

Grows tiny plants (three scans of about 300 points), starts a scheduler and workers as processes of
their own, and bakes all plants with `bake --cluster`. Printed are plants a second, the processor
time a plant takes on the workers, and the memory (RSS) of each worker, of the scheduler and of the
command at the start (a tenth of the plants done), in the middle and at the end. Fails if a clip is
missing, can't be opened, or a worker's memory grew by more than a tenth from the start to the end.
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
from baker.scans import Series, read_series
from grow.series import Plan, write_series

KINDS = ("maize", "tomato", "tree")
GROWN = 9  # plants; the others are these, turned
MARKS = (0.1, 0.5, 1.0)
MAX_GROWTH = 1.1


def grow_plants(house: Path, plants: int, scans: int, points: int) -> None:
    """Write plants into folders of their own below `house`; each is another one turned."""
    grown: list[Series] = []
    for number in range(plants):
        kind = KINDS[number % len(KINDS)]
        folder = house / f"{kind}{number:05d}"
        if number < GROWN:
            write_series(Plan(kind, number, scans, points=(points, points)), folder)
            grown.append(read_series([folder]))
            continue
        folder.mkdir()
        sine, cosine = np.sin(number), np.cos(number)
        turn = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
        for scan in grown[number % GROWN].scans:
            table = np.column_stack([scan.points @ turn.T, scan.labels])
            np.savetxt(folder / f"{Path(scan.name).stem}.txt", table, fmt="%.3f %.3f %.3f %d")


@contextmanager
def started(workers: int, folder: Path) -> Iterator[tuple[str, dict[str, int]]]:
    """A scheduler and workers as processes; its address, and their process ids by name."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    commands = {"scheduler": ["dask_scheduler", "--host", "127.0.0.1", "--port", str(port)]}
    for number in range(workers):
        commands[f"worker {number}"] = ["dask_worker", address, "--nthreads", "1", "--no-nanny"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": folder}
    path = os.pathsep.join([os.getcwd(), os.environ.get("PYTHONPATH", "")])
    # The profiler keeps call stacks of the last hour: memory that grows for an hour.
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
    """Resident megabytes."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def processor(pid: int) -> float:
    """Seconds of processor time so far."""
    ticks = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[11:13]
    return sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--plants", type=int, default=500)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--scans", type=int, default=3)
    parser.add_argument("--points", type=int, default=300, help="of each scan")
    parser.add_argument("--align", default="auto", help="as of bake; none is several times faster")
    arguments = parser.parse_args()
    with ExitStack() as stack:
        scratch = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        house, clips = scratch / "house", scratch / "clips"
        grow_plants(house, arguments.plants, arguments.scans, arguments.points)
        address, pids = stack.enter_context(started(arguments.workers, scratch))
        command = [sys.executable, "-m", "baker", str(house), "-o", f"{clips}/", "-q"]
        began = time.perf_counter()
        bake = subprocess.Popen([*command, "--align", arguments.align, "--cluster", address])
        pids["bake"] = bake.pid
        seen = watch(bake, clips, pids, arguments.plants)
        wall = time.perf_counter() - began
        if bake.wait():
            raise SystemExit("the bake failed")
        spent = {name: processor(pid) for name, pid in pids.items() if name != "bake"}
        whole = [gclip.open(path) for path in sorted(clips.iterdir())]
        each = {name: seconds / len(whole) for name, seconds in spent.items()}
        print(
            f"{len(whole)} of {arguments.plants} plants in {wall:.1f} s: {len(whole) / wall:.2f} a "
            f"second; of processor each {sum(each.values()) - each['scheduler']:.3f} s by workers, "
            f"{each['scheduler']:.4f} s by the scheduler"
        )
        if len(whole) != arguments.plants:
            raise SystemExit("plants were lost")
    first, last = seen[MARKS[0]], seen[MARKS[-1]]
    grown = [name for name in first if name[0] == "w" and last[name] > MAX_GROWTH * first[name]]
    if grown:
        raise SystemExit(f"memory grew: {', '.join(grown)}")


def watch(
    bake: subprocess.Popen, clips: Path, pids: dict[str, int], plants: int
) -> dict[float, dict[str, float]]:
    """Print and return each process's memory when so many plants are done."""
    seen: dict[float, dict[str, float]] = {}
    for mark in MARKS:
        while bake.poll() is None and sum(1 for _ in clips.glob("*.gclip")) < mark * plants:
            time.sleep(0.05)
        if bake.poll() is None:
            seen[mark] = {name: memory(pid) for name, pid in pids.items()}
            line = ", ".join(f"{name} {found:.0f} MB" for name, found in seen[mark].items())
            print(f"{mark:4.0%} done: {line}", flush=True)
    return seen


if __name__ == "__main__":
    main()
