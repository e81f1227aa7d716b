"""Fuzz what reads and bakes scans: `python -m bench.fuzz_scans --cases 1000 --seed 1`.

    --cases N     how many of each kind (series from hell, damaged files)
    --seed S      another seed draws other cases
    --minutes M   stop after that long
    --only KIND   series or files

Prints each kind of failure once, with its traceback and the case that shows it, and how many cases
were baked, read or refused. A case that takes longer than `--limit` seconds ends the run, as one
that hangs might. Exit code 1 where anything failed.
"""

from __future__ import annotations

import argparse
import faulthandler
import re
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

CHUNK = 100  # cases that hypothesis draws from one seed


@dataclass
class Tally:
    """What came of the cases of one kind, and one example of each failure."""

    cases: int = 0
    outcomes: Counter[str] = field(default_factory=Counter)
    failures: dict[str, str] = field(default_factory=dict)
    slowest: float = 0.0
    slow_case: str = ""
    sentences: Counter[str] = field(default_factory=Counter)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--minutes", type=float, default=float("inf"))
    parser.add_argument("--limit", type=float, default=60.0)
    parser.add_argument("--only", choices=("series", "files"))
    parser.add_argument("--kind", default="", help="only files of kinds that begin so")
    asked = parser.parse_args()

    kinds = [asked.only] if asked.only else ["files", "series"]
    until = time.monotonic() + 60 * asked.minutes
    failed = False
    for kind in kinds:
        tally = fuzz(*_subject(kind, asked.kind), asked.cases, asked.seed, until, asked.limit)
        _tell(kind, tally)
        failed |= bool(tally.failures)
    return int(failed)


def _subject(kind: str, begins: str) -> tuple[Any, Callable[[Any, Path], str]]:
    """What to draw, and what to do with it."""
    if kind == "series":
        from tests.baker.hostile_series import all_series, check_series

        return all_series(), check_series
    from tests.baker.hostile_files import all_files, check_file

    return all_files(begins), check_file


def fuzz(
    strategy: Any,
    check: Callable[[Any, Path], str],
    cases: int,
    seed: int,
    until: float,
    limit: float,
) -> Tally:
    """Check cases drawn from the strategy until there were so many, or time is up."""
    import hypothesis

    tally = Tally()

    def one(case: Any) -> None:
        if tally.cases >= cases or time.monotonic() > until:
            return
        tally.cases += 1
        began = time.monotonic()
        print(case, file=log, flush=True)
        faulthandler.dump_traceback_later(limit, exit=True)
        with tempfile.TemporaryDirectory() as folder:
            try:
                outcome = check(case, Path(folder))
                is_sentence = outcome not in ("baked", "read")
                tally.outcomes["refused" if is_sentence else outcome] += 1
                tally.sentences[_gist(outcome)] += is_sentence
            except Exception as error:
                tally.outcomes["failed"] += 1
                tally.failures.setdefault(_place(error), f"{case}\n{traceback.format_exc()}")
        faulthandler.cancel_dump_traceback_later()
        took = time.monotonic() - began
        if took > tally.slowest:
            tally.slowest, tally.slow_case = took, str(case)

    settings = hypothesis.settings(
        max_examples=CHUNK,
        deadline=None,
        database=None,
        phases=[hypothesis.Phase.generate],
        suppress_health_check=list(hypothesis.HealthCheck),
    )
    with tempfile.NamedTemporaryFile("w", prefix="fuzz_scans_", suffix=".txt") as log:
        print(f"the case at work stands at the end of {log.name}")
        chunk = 0
        while tally.cases < cases and time.monotonic() < until:
            hypothesis.seed((seed << 20) + chunk)(settings(hypothesis.given(strategy)(one)))()
            chunk += 1
    return tally


def _place(error: BaseException) -> str:
    """The kind of error, and the last line of ours that it came through."""
    frames = traceback.extract_tb(error.__traceback__)
    ours = [f for f in frames if "/baker/" in f.filename or "/gclip/" in f.filename] or frames
    return f"{type(error).__name__} in {Path(ours[-1].filename).name}:{ours[-1].lineno}"


def _gist(sentence: str) -> str:
    """A sentence without its names and numbers."""
    return re.sub(r"[-+]?\d[\d.e+]*|'[^']*'", "_", sentence)[:100]


def _tell(kind: str, tally: Tally) -> None:
    for place, story in tally.failures.items():
        print(f"\n--- {place}\n{story}")
    for sentence, count in tally.sentences.most_common(20):
        print(f"{count:7} {sentence}")
    outcomes = ", ".join(f"{count} {name}" for name, count in tally.outcomes.most_common())
    print(f"{kind}: {tally.cases} cases: {outcomes}")
    print(f"{kind}: the slowest took {tally.slowest:.1f} s: {tally.slow_case}")


if __name__ == "__main__":
    sys.exit(main())
