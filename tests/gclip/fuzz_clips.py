"""Fuzz `gclip.open` and what the player does with a clip.

    python -m tests.gclip.fuzz_clips --count 100000 --seed 1

    --count N      how many files
    --seed S       another seed draws other files
    --minutes M    stop after that long
    --workers W    processes that work side by side (2)
    --keep FOLDER  keep the files that show a failure
    --only CASE    one case in this process, with its traceback

A file is drawn and opened. If it is no clip it must be refused by a ClipError of one sentence that
names the file. If it is one, `gclip check` and one of the player's uses of it follow: evaluation,
`--info`, all that the window loads and writes, an export, a small picture. None may fail otherwise
than by a sentence. Opening, checking and loading may take up twice the file's size and 64 MB more,
no page beyond the file, and at most 20 seconds. Exit code 1 where anything failed.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

SPARE = 64_000_000  # bytes
LONGEST = 20.0  # seconds of a case
ADDRESS_SPACE = 4 << 30  # bytes beyond what a worker begins with: what asks for more gets none
LIGHT = ["evaluated", "told", "loaded"]  # uses that take a few milliseconds


class Failure(Exception):
    """A promise that was not kept."""


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--minutes", type=float, default=float("inf"))
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--keep", type=Path)
    parser.add_argument("--only", type=int, help="one case, with its traceback")
    asked = parser.parse_args()

    if asked.only is not None:
        print(outcome(asked.seed, asked.only, Path(tempfile.mkdtemp()), _uses()))
        return 0
    began, counts = time.monotonic(), Counter[str]()
    starts = range(asked.workers)
    workers = [Worker(asked.seed, first, asked.count, asked.workers) for first in starts]
    failures: dict[str, int] = {}
    while any(worker.busy for worker in workers):
        for worker in workers:
            worker.look(counts, failures)
            if time.monotonic() > began + 60 * asked.minutes:
                worker.stop()
        time.sleep(0.2)
    print(f"{sum(counts.values()):,} cases of seed {asked.seed}, {time.monotonic() - began:.0f} s")
    for what, count in counts.most_common():
        print(f"{count:8,} {what}")
    for what, case in failures.items():
        print(f"FAILED, case {case}: {what}")
        if asked.keep:
            from tests.gclip.hostile import hostile

            asked.keep.mkdir(parents=True, exist_ok=True)
            name = asked.keep / f"{asked.seed}-{case}.gclip"
            name.write_bytes(hostile(Random(f"{asked.seed}-{case}")))
    return 1 if failures else 0


class Worker:
    """A process that checks every `step`-th case, and is replaced where it dies."""

    def __init__(self, seed: int, first: int, cases: int, step: int) -> None:
        self._seed, self._next, self._cases, self._step = seed, first, cases, step
        self.busy = True
        self._start()

    def _start(self) -> None:
        fresh = multiprocessing.get_context("spawn")
        self._events, sending = fresh.Pipe(duplex=False)
        rest = range(self._next, self._cases, self._step)
        self._process = fresh.Process(target=work, args=(self._seed, rest, sending), daemon=True)
        self._process.start()
        sending.close()
        self._heard = time.monotonic() + 60.0  # the first case waits for all imports

    def look(self, counts: Counter[str], failures: dict[str, int]) -> None:
        """Take over what it has found; see to it that it lives."""
        if not self.busy:
            return
        try:
            while self._events.poll():
                case, found = self._events.recv()
                self._next, self._heard = case + self._step, time.monotonic()
                counts[found.partition("\n")[0]] += 1
                if found.startswith("failed"):
                    failures.setdefault(found, case)
        except EOFError:
            self._process.join()
            self._died(f"crashed with code {self._process.exitcode}", failures)
            return
        if time.monotonic() > self._heard + LONGEST:
            self._process.kill()
            self._died(f"hung for {LONGEST:g} s", failures)

    def _died(self, how: str, failures: dict[str, int]) -> None:
        if self._next >= self._cases:
            self.busy = False
            return
        failures.setdefault(how, self._next)
        self._next += self._step
        self._start()

    def stop(self) -> None:
        self._next = self._cases
        self._process.kill()


def work(seed: int, cases: range, events: Any) -> None:
    """What a worker does: one line for each case."""
    import resource

    uses = _uses()
    space = _status("VmSize") + ADDRESS_SPACE
    resource.setrlimit(resource.RLIMIT_AS, (space, space))
    sys.stdout = sys.stderr = open(os.devnull, "w")  # noqa: SIM115 - drivers and typer talk
    with tempfile.TemporaryDirectory() as folder:
        for case in cases:
            events.send((case, outcome(seed, case, Path(folder), uses)))


def outcome(seed: int, case: int, folder: Path, uses: dict[str, Callable]) -> str:
    """What came of one case: "failed", with the reason on the lines below, or how it ended."""
    from gclip.errors import UserError
    from tests.gclip.hostile import hostile

    random = Random(f"{seed}-{case}")
    path = folder / "case.gclip"
    path.unlink(missing_ok=True)  # an earlier clip, still mapped, keeps its file
    path.write_bytes(hostile(random))
    name = "open"
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)
            clip = opened(path)
            if clip is None:
                return "refused"
            name = random.choice(LIGHT if random.random() < 0.8 else list(uses))
            if name == "loaded":
                within_memory(path, lambda: uses[name](clip, path))
            else:
                uses[name](clip, path)
    except UserError as error:
        sentence = str(error)
        plain = sentence.endswith(".") and sentence.isprintable()
        return f"{name}: refused later" if plain else f"failed\n{name}: {sentence!r}"
    except Exception as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        own = [f for f in traceback.extract_tb(error.__traceback__) if "tests" not in f.filename]
        places = ", ".join(f"{Path(f.filename).name}:{f.lineno}" for f in (*own[-2:], where))
        return f"failed\n{name}: {type(error).__name__}: {str(error)[:200]} at {places}"
    return f"{name}: done"


def opened(path: Path) -> Any:
    """The clip, or None where it is refused as it should be."""
    import gclip
    from gclip import check

    found: list[Any] = []

    def open_() -> None:
        try:
            found.append(gclip.open(path))
        except gclip.ClipError as error:
            check_sentence(str(error), path)

    def check_() -> None:
        try:
            check(path)
        except gclip.ClipError:
            return
        if not found:
            raise Failure("check praises what open refuses")

    within_memory(path, open_)
    within_memory(path, check_)
    if not found:
        return None
    check_reach(found[0], path)
    return found[0]


def check_sentence(sentence: str, path: Path) -> None:
    if not (sentence.startswith(str(path)) and sentence.endswith(".") and sentence.isprintable()):
        raise Failure(f"no sentence that names the file: {sentence!r}")
    if len(sentence) > 600:
        raise Failure(f"a sentence of {len(sentence)} characters")


def check_reach(clip: Any, path: Path) -> None:
    """No buffer goes beyond the file that is mapped."""
    from numpy.lib.array_utils import byte_bounds

    for interval in clip.intervals:
        for buffer in (*interval.curve, interval.tracks):
            first, last = byte_bounds(buffer)
            whole = buffer
            while getattr(whole, "base", None) is not None and hasattr(whole.base, "dtype"):
                whole = whole.base
            low, high = byte_bounds(whole)
            if not (low <= first <= last <= high and whole.nbytes == path.stat().st_size):
                raise Failure("a buffer that goes beyond the file")


def within_memory(path: Path, job: Callable[[], Any]) -> None:
    """Run a job; fail where it took up more than twice the file and 64 MB."""
    Path("/proc/self/clear_refs").write_text("5")  # forget the highest so far (Linux)
    before = _status("VmRSS")
    job()
    taken = _status("VmHWM") - before
    if taken > 2 * path.stat().st_size + SPARE:
        raise Failure(f"{taken:,} bytes for a file of {path.stat().st_size:,}")


def _status(name: str) -> int:
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(f"{name}:"):
            return 1024 * int(line.split()[1])
    return 0


def _uses() -> dict[str, Callable]:
    """By name; loads what they need, so that no case is charged with it."""
    from scipy.spatial import cKDTree

    from tests.player.uses import USES, drawn, overlaid

    assert cKDTree is not None
    return {**USES, "drawn": drawn, "overlaid": overlaid}


if __name__ == "__main__":
    sys.exit(main())
