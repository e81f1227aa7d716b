"""Bakes and exports killed at random moments: is the old output intact, or the new one whole?

    python -m tests.kill [--count 200] [--seed 0] [--only bake,mp4,...]
        [--signals SIGKILL,SIGINT]

Every command runs in a process of its own, forked from one that has imported all it needs, and is
killed (SIGKILL), half of the time at any moment, half of the time within 50 ms after its draft
appears, which is when it writes. This goes on until each has been killed so many times: a run that
ends before it is killed does not count.
Each file at the output must then be what was there before, or what a run that is left alone writes;
nothing else but its draft. Then as many are stopped by Ctrl-C (SIGINT): they must end with exit
code 130 and leave no draft either. Now and then a run is left alone: it must come out right
whatever killed ones have left, and leave nothing itself.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from tests.writers import (
    PATIENCE,
    Writer,
    contents,
    drafts,
    is_whole,
    leftovers,
    make_series,
    run_alone,
    start,
    varied,
    writers,
)

SOON = 0.05  # seconds after a draft appears
BEGUN = 0.05  # seconds after which a command can be stopped
EVERY = 10  # kills, after which a run is left alone
INTERRUPTED = 130  # exit code


def stopped(
    writer: Writer, folder: Path, duration: float, chance: random.Random, stop: signal.Signals
) -> tuple[int | None, float]:
    """Start the command and stop it; its exit code, and how many seconds it ran."""
    before = drafts(folder)
    at_draft, due = chance.random() < 0.5, chance.uniform(BEGUN, max(BEGUN, duration))
    process = start(writer.module, writer.new, folder)
    began = time.monotonic()
    while process.is_alive():
        late = time.monotonic() - began
        if at_draft and drafts(folder) - before:
            at_draft, due = False, late + chance.uniform(0, SOON)
        if not at_draft and late >= due:
            with suppress(ProcessLookupError):  # it has just ended
                os.kill(process.pid, stop)
            break
        time.sleep(0.001)
    process.join(PATIENCE)
    return process.exitcode, time.monotonic() - began


def try_out(writer: Writer, count: int, seed: int, signals: Sequence[str]) -> Counter[str]:
    """Stop it so many times by each signal.

    Counts these, and what was left: old, new or broken outputs, and litter.
    """
    chance = random.Random(f"{seed} {writer.name}")
    left: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as name:
        folder, olds, news = (Path(name) / part for part in ("here", "old", "new"))
        for place, arguments in ((olds, writer.old), (news, writer.new)):
            place.mkdir()
            began = time.monotonic()
            run_alone(writer.module, arguments, place)
            duration = time.monotonic() - began
        shutil.copytree(olds, folder)
        for stop in signals:
            while left[stop] < count:
                before = leftovers(writer, folder)
                code, seconds = stopped(writer, folder, duration, chance, signal.Signals[stop])
                duration = duration if code else seconds  # as the machine is busy now
                hit = code == (INTERRUPTED if stop == "SIGINT" else -signal.SIGKILL)
                left[stop if hit else "wrong exit" if code else "too late"] += 1
                if code and not hit:
                    print(f"{writer.name}: exit code {code} after {stop}", flush=True)
                left.update(_looked_at(writer, folder, olds, news))
                if stop != "SIGKILL":
                    left["litter"] += _counted(writer, leftovers(writer, folder) - before)
                alone = hit and (left[stop] % EVERY == 0 or left[stop] == count)
                if alone:
                    left["litter"] += _litter(writer, folder, news)
                for output in writer.outputs:
                    if alone or output != "cache":  # which other runs are to go on with
                        _restore(folder, olds, output)
    return left


def _looked_at(writer: Writer, folder: Path, olds: Path, news: Path) -> Counter[str]:
    """How many outputs are old, new and broken."""
    found: Counter[str] = Counter()
    for output in writer.outputs:
        files = contents(folder, output)
        if files == contents(olds, output):
            found["old"] += 1
        elif is_whole(files, olds, news, output) or varied(writer, output, files):
            found["new"] += 1
        else:
            found["broken"] += 1
            print(f"{writer.name}: {output} is broken", flush=True)
    return found


def _litter(writer: Writer, folder: Path, news: Path) -> int:
    """How much a run that is left alone leaves beside the outputs; checks that it is right."""
    before = {path.name for path in folder.rglob("*")}
    run_alone(writer.module, writer.new, folder)
    for output in writer.outputs:
        if output not in writer.varying and contents(folder, output) != contents(news, output):
            raise SystemExit(f"{writer.name}: {output} is wrong after a run that was left alone")
    return _counted(writer, leftovers(writer, folder) - before)


def _counted(writer: Writer, found: set[str]) -> int:
    if found:
        print(f"{writer.name}: litter: {', '.join(sorted(found))}", flush=True)
    return len(found)


def _restore(folder: Path, olds: Path, output: str) -> None:
    place, old = folder / output, olds / output
    if place.is_dir():
        shutil.rmtree(place)
    place.unlink(missing_ok=True)
    if old.is_dir():
        shutil.copytree(old, place)
    elif old.exists():
        shutil.copy(old, place)


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--count", type=int, default=200, help="of each, by each signal")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", default="", help="names, with commas between")
    parser.add_argument("--signals", default="SIGKILL,SIGINT")
    asked = parser.parse_args(argv)
    with tempfile.TemporaryDirectory() as name:
        chosen = writers(*make_series(Path(name)))
        if asked.only:
            chosen = [writer for writer in chosen if writer.name in asked.only.split(",")]
        total: Counter[str] = Counter()
        for writer in chosen:
            left = try_out(writer, asked.count, asked.seed, asked.signals.split(","))
            print(f"{writer.name}: {_told(left)}", flush=True)
            total += left
    print(f"all: {_told(total)}")
    return 1 if total["wrong exit"] or total["broken"] or total["litter"] else 0


def _told(left: Counter[str]) -> str:
    names = ("SIGKILL", "SIGINT", "too late", "wrong exit", "old", "new", "broken", "litter")
    return ", ".join(f"{left[name]} {name}" for name in names)


if __name__ == "__main__":
    sys.exit(main())
