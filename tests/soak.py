"""Many small plants baked by one command: does its memory stay flat, is anything left behind?

    python -m tests.soak [--plants 500] [--workers 2] [--every 50]

Prints the memory of all processes of the command (resident, in MB) each time so many more clips are
there. Exit code 1 where it grew by more than a tenth, measured from the second figure on, where
plants of the same scans have clips of other bytes, or where anything but the clips is left. Needs
Linux's `ps`.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.baker.batch.conftest import write_greenhouse
from tests.baker.conftest import write_las

KINDS = 10  # plants of different scans
GROWTH = 1.1


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--plants", type=int, default=500)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--every", type=int, default=50)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        house, clips = Path(name, "house"), Path(name, "clips")
        write_greenhouse(house, [f"p{k:02d}" for k in range(KINDS - 1)])
        write_las(house / f"p{KINDS - 1:02d}")  # which a child process reads
        for k in range(KINDS, asked.plants):
            (house / f"p{k:02d}").symlink_to(f"p{k % KINDS:02d}")
        command = [sys.executable, "-m", "baker", str(house), "-o", f"{clips}/", "-q"]
        command += ["--align", "none", "--workers", str(asked.workers)]
        figures = watched(command, clips, asked.every)
        faults = [f"it grew from {figures[1]} to {max(figures)} MB"] * (
            max(figures[2:], default=0) > GROWTH * figures[1]
        )
        found = sorted(path.name for path in clips.iterdir())
        if found != sorted(f"p{k:02d}.gclip" for k in range(asked.plants)):
            faults.append(f"{len(found)} files are in the folder of {asked.plants} clips")
        kinds = {(clips / f"p{k:02d}.gclip").read_bytes() for k in range(asked.plants)}
        if len(kinds) != KINDS:
            faults.append(f"{KINDS} plants have {len(kinds)} clips")
    print("; ".join(faults) or "flat, whole, and nothing left")
    return 1 if faults else 0


def watched(command: list[str], clips: Path, every: int) -> list[int]:
    """Run it; its processes' memory in MB each time so many more clips are there."""
    process = subprocess.Popen(command, start_new_session=True)
    figures: list[int] = []
    while process.poll() is None:
        baked = len(list(clips.glob("p*.gclip"))) if clips.is_dir() else 0
        if baked >= every * (len(figures) + 1):
            table = ["ps", "-o", "rss=", "-g", str(process.pid)]
            memory = subprocess.run(table, capture_output=True, text=True, check=True).stdout
            figures.append(sum(map(int, memory.split())) // 1000)
            print(f"{baked:5} clips: {figures[-1]:5} MB", flush=True)
        time.sleep(0.02)
    if process.returncode:
        raise SystemExit(f"exit code {process.returncode}")
    return figures


if __name__ == "__main__":
    sys.exit(main())
