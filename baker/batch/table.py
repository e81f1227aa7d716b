"""What came of many plants: a table for people."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

from baker.batch.work import Outcome
from gclip.terminal.command import DONE, OUR_FAULT

COLUMNS = ("scans", "tracks", "points", "seconds")


def result_lines(outcomes: Sequence[Outcome]) -> Iterator[str]:
    """A header and a line a plant."""
    width = max(len("plant"), *(len(one.name) for one in outcomes))
    yield f"{'plant':<{width}}" + "".join(f"{name:>10}" for name in COLUMNS) + "  result"
    for one in outcomes:
        failed = one.state == "failed"
        found = ("", "", "") if failed else (one.scans, one.tracks, f"{one.points:,}")
        numbers = "".join(f"{value:>10}" for value in (*found, f"{one.seconds:.1f}"))
        yield f"{one.name:<{width}}{numbers}  {one.state}"


def sum_line(outcomes: Sequence[Outcome], seconds: float) -> str:
    """How many plants were baked, stood, failed, and how long it all took."""
    states = Counter(one.state for one in outcomes)
    told = ", ".join(f"{states[s]:,} {s}" for s in ("baked", "unchanged", "failed") if states[s])
    points = sum(one.points for one in outcomes)
    plants = f"{len(outcomes):,} plant{'s' * (len(outcomes) != 1)}"
    return f"{plants}: {told}; {points:,} points in {seconds:.1f} s"


def exit_code(outcomes: Iterable[Outcome]) -> int:
    """The worst of all: a fault of our own, else bad input, else done."""
    codes = {one.code for one in outcomes}
    return OUR_FAULT if OUR_FAULT in codes else max(codes, default=DONE)
