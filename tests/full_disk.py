"""Bakes and exports onto a disk that fills up: is the old output intact, or the new one whole?

    python -m tests.full_disk [--steps 8] [--only bake,mp4,...]

Mounts file systems in memory, so it has to be run by root on Linux: each a little larger than the
last, the first with room for no more than the old outputs, the last with room for old and new ones.
A command must end with exit code 0, or with 2 and one sentence that says the disk is full, and
leave nothing but its outputs, each the old or the new one.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from tests.writers import (
    Writer,
    contents,
    is_whole,
    leftovers,
    make_series,
    run_alone,
    varied,
    writers,
)

PAGE = 4096  # bytes that a file in memory takes at least
FULL = "No space left on device"


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--steps", type=int, default=8)
    parser.add_argument("--only", default="", help="names, with commas between")
    asked = parser.parse_args(argv)
    total: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as name:
        for writer in writers(*make_series(Path(name))):
            if writer.outputs and (not asked.only or writer.name in asked.only.split(",")):
                found = try_out(writer, asked.steps)
                print(f"{writer.name}: {_told(found)}", flush=True)
                total += found
    print(f"all: {_told(total)}")
    return 1 if total["broken"] else 0


def try_out(writer: Writer, steps: int) -> Counter[str]:
    """Counts how the command ended on disks of some sizes."""
    found: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as name:
        olds, news, disk = (Path(name) / part for part in ("old", "new", "disk"))
        for place, arguments in ((olds, writer.old), (news, writer.new)):
            place.mkdir()
            run_alone(writer.module, arguments, place)
        disk.mkdir()
        for step in range(steps + 1):
            size = _taken(olds) + (_taken(news) + 16 * PAGE) * step // steps
            with mounted(disk, size):
                shutil.copytree(olds, disk, dirs_exist_ok=True)
                command = [sys.executable, "-m", writer.module.partition(".")[0], *writer.new]
                done = subprocess.run(command, cwd=disk, capture_output=True, text=True)
                fault = _fault(writer, done, disk, olds, news)
            found["broken" if fault else "done" if done.returncode == 0 else "refused"] += 1
            if fault:
                print(f"{writer.name}, {size:,} bytes: {fault}\n{done.stderr}", flush=True)
    return found


def _fault(
    writer: Writer, done: subprocess.CompletedProcess, disk: Path, olds: Path, news: Path
) -> str:
    """What is wrong with how it ended, if anything."""
    if done.returncode not in (0, 2):
        return f"exit code {done.returncode}"
    if done.returncode == 2 and (FULL not in done.stderr or len(done.stderr.splitlines()) > 1):
        return "the sentence doesn't say it"
    if litter := leftovers(writer, disk):
        return f"litter: {', '.join(sorted(litter))}"
    for output in writer.outputs:
        found = contents(disk, output)
        if found == contents(olds, output) or is_whole(found, olds, news, output):
            continue
        if not varied(writer, output, found):
            return f"{output} is broken"
    return ""


def _taken(folder: Path) -> int:
    """Bytes of memory that a folder takes, with its folders."""
    files = [path.stat().st_size if path.is_file() else 1 for path in folder.rglob("*")]
    return sum(-(-size // PAGE) * PAGE for size in files) + PAGE


@contextmanager
def mounted(disk: Path, size: int) -> Iterator[None]:
    """A file system of this size."""
    options = f"size={size},nr_inodes=1000"
    subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", disk], check=True)
    try:
        yield
    finally:
        subprocess.run(["umount", disk], check=True)


def _told(found: Counter[str]) -> str:
    return ", ".join(f"{found[name]} {name}" for name in ("done", "refused", "broken"))


if __name__ == "__main__":
    sys.exit(main())
