"""Fuzz what reads and bakes scans: `python -m tests.baker.fuzz_scans --count 1000 --seed 1`.

    --count N     how many of each kind (strange series, damaged files)
    --seed S      another seed draws other cases
    --minutes M   stop after that long
    --only KIND   series or files
    --kind NAME   only files of kinds that begin so ("las", "ply binary")
    --limit S     seconds that a case may take

Cases run in child processes, so that a reader which ends its process is seen and counted. Prints
each kind of failure once, with its traceback and the case that shows it, and how many cases were
baked, read or refused. Exit code 1 where anything failed.
"""

from __future__ import annotations

import argparse
import multiprocessing
import re
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

CHUNK = 250  # cases that hypothesis draws from one seed, in one child process


@dataclass
class Tally:
    """What came of the cases of one kind, and one example of each failure."""

    cases: int = 0
    outcomes: Counter[str] = field(default_factory=Counter)
    failures: dict[str, str] = field(default_factory=dict)
    slowest: float = 0.0
    slow_case: str = ""
    sentences: Counter[str] = field(default_factory=Counter)

    def add(self, case: str, outcome: str, failure: tuple[str, str] | None, seconds: float) -> None:
        """Count a case; failure: where it failed, and the traceback."""
        self.cases += 1
        if failure:
            self.outcomes["failed"] += 1
            self.failures.setdefault(failure[0], f"{case}\n{failure[1]}")
        else:
            is_sentence = outcome not in ("baked", "read")
            self.outcomes["refused" if is_sentence else outcome] += 1
            self.sentences[_gist(outcome)] += is_sentence
        if seconds > self.slowest:
            self.slowest, self.slow_case = seconds, case


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--minutes", type=float, default=float("inf"))
    parser.add_argument("--limit", type=float, default=60.0)
    parser.add_argument("--only", choices=("series", "files"))
    parser.add_argument("--kind", default="", help="only files of kinds that begin so")
    options = parser.parse_args()

    kinds = [options.only] if options.only else ["files", "series"]
    until = time.monotonic() + 60 * options.minutes
    failed = False
    for kind in kinds:
        tally = Tally()
        chunk = 0
        while tally.cases < options.count and time.monotonic() < until:
            count = min(CHUNK, options.count - tally.cases)
            seed = (options.seed << 20) + chunk
            _fuzz_in_child(tally, (kind, options.kind, seed, count), until, options.limit)
            chunk += 1
        _report(kind, tally)
        failed |= bool(tally.failures)
    return int(failed)


def _fuzz_in_child(
    tally: Tally, work: tuple[str, str, int, int], until: float, limit: float
) -> None:
    """Count the cases of one child process, and its death as one of them."""
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    child = context.Process(target=_fuzz, args=(*work, sender))
    child.start()
    sender.close()
    case = "before the first case"
    try:
        while time.monotonic() < until:
            if not receiver.poll(limit + 60 * (case == "before the first case")):
                child.kill()
                tally.add(case, "", (f"took more than {limit:g} s", ""), limit)
                break
            case, *rest = receiver.recv()
            if rest:
                tally.add(case, *rest)
    except EOFError:
        child.join()
        if child.exitcode:
            tally.add(case, "", (f"the process ended with {child.exitcode}", ""), 0.0)
    child.kill()
    child.join()


def _fuzz(kind: str, begins: str, seed: int, count: int, results: Connection) -> None:
    """Check so many cases; sends each case, and again with what came of it."""
    import hypothesis

    from tests.baker.hostile_files import load_libraries

    strategy, check = _subject(kind, begins)
    load_libraries()  # no case is charged with it

    def check_case(case: Any) -> None:
        results.send((str(case),))
        began, failure, outcome = time.monotonic(), None, ""
        with tempfile.TemporaryDirectory() as folder:
            try:
                outcome = check(case, Path(folder))
            except Exception as error:
                failure = _place(error), traceback.format_exc()
        results.send((str(case), outcome, failure, time.monotonic() - began))

    settings = hypothesis.settings(
        max_examples=count,
        deadline=None,
        database=None,
        phases=[hypothesis.Phase.generate],
        suppress_health_check=list(hypothesis.HealthCheck),
    )
    hypothesis.seed(seed)(settings(hypothesis.given(strategy)(check_case)))()


def _subject(kind: str, begins: str) -> tuple[Any, Callable[[Any, Path], str]]:
    """What to draw, and what to do with it."""
    if kind == "series":
        from tests.baker.hostile_series import all_series, check_series

        return all_series(), check_series
    from tests.baker.hostile_files import all_files, check_file

    return all_files(begins), check_file


def _place(error: BaseException) -> str:
    """The kind of error, and the last line of ours that it came through."""
    frames = traceback.extract_tb(error.__traceback__)
    ours = [f for f in frames if "/baker/" in f.filename or "/gclip/" in f.filename] or frames
    return f"{type(error).__name__} in {Path(ours[-1].filename).name}:{ours[-1].lineno}"


def _gist(sentence: str) -> str:
    """A sentence without its names and numbers."""
    return re.sub(r"[-+]?\d[\d.e+]*|'[^']*'", "_", sentence)[:100]


def _report(kind: str, tally: Tally) -> None:
    for place, story in tally.failures.items():
        print(f"\n--- {place}\n{story}")
    for sentence, count in tally.sentences.most_common(20):
        print(f"{count:7} {sentence}")
    outcomes = ", ".join(f"{count} {name}" for name, count in tally.outcomes.most_common())
    print(f"{kind}: {tally.cases} cases: {outcomes}")
    print(f"{kind}: the slowest took {tally.slowest:.1f} s: {tally.slow_case}")


if __name__ == "__main__":
    sys.exit(main())
