"""What may be wrong in a clip, and how a bake says so."""

import shlex
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from gclip import Clip

MIN_SHARE = 0.03  # of a scan's points, in an organ that one sees (docs/method.md, "The verdict")
MAX_INTERVALS_NAMED = 3  # in the verdict's line, the most doubtful ones
MAX_ORGANS_NAMED = 2  # in each of these


@dataclass(frozen=True)
class Doubt:
    """One organ in one interval that looks wrong."""

    start: float  #: times of the interval's scans
    end: float
    track: int
    what: str  #: a clause: "organ 3 tears"
    #: What was measured over the least that counts: 1 is just doubtful.
    strength: float
    #: Whether it is in doubt which organ this is, and not only how it moves.
    identity: bool = False


def provenance_of(clip: Clip, doubts: Sequence[Doubt]) -> dict[str, Any]:
    """The verdict as a clip's provenance holds it (docs/format.md)."""
    return {"line": line_of(clip, doubts), "doubts": [asdict(doubt) for doubt in doubts]}


def doubts_in(clip: Clip) -> list[Doubt]:
    """The doubts that a bake wrote into its clip."""
    return [Doubt(**doubt) for doubt in clip.provenance["verdict"]["doubts"]]


def line_of(clip: Clip, doubts: Sequence[Doubt]) -> str:
    """One line for the user: how many intervals look right, and what is wrong in the others."""
    by_interval = grouped(doubts)
    named = sorted(by_interval[:MAX_INTERVALS_NAMED], key=lambda own: own[0].start)
    said = [f"{between(clip, own[0])}: {_listed(own)}" for own in named]
    if more := len(by_interval) - len(named):
        said.append(f"and {more} more interval{'s' * (more > 1)}")
    return "; ".join([headline(clip, doubts), *said]) + "."


def headline(clip: Clip, doubts: Sequence[Doubt]) -> str:
    """How many intervals look right."""
    count, wrong = len(clip.intervals), len(grouped(doubts))
    if count == 1:
        return "The interval does not look right" if wrong else "The interval looks right"
    if not wrong:
        return f"All {count} intervals look right"
    return f"{count - wrong or 'None'} of {count} intervals look{'s' * (count - wrong < 2)} right"


def _listed(doubts: Sequence[Doubt]) -> str:
    clauses = clauses_of(doubts)
    said, more = clauses[:MAX_ORGANS_NAMED], len(clauses) - MAX_ORGANS_NAMED
    return ", ".join(said + [f"and {more} more"] * (more > 0))


def clauses_of(doubts: Sequence[Doubt]) -> list[str]:
    """What is said, each once: two organs that may be mixed up are two doubts."""
    return list(dict.fromkeys(doubt.what for doubt in doubts))


def command_for(doubt: Doubt, path: str | Path) -> str:
    """The command that shows a doubtful interval half-way."""
    return f"play {shlex.quote(str(path))} --day {(doubt.start + doubt.end) / 2:.10g}"


def grouped(doubts: Sequence[Doubt]) -> list[list[Doubt]]:
    """The doubts of each doubtful interval, in both the strongest first."""
    by_interval: dict[float, list[Doubt]] = {}
    for doubt in sorted(doubts, key=lambda doubt: -doubt.strength):
        by_interval.setdefault(doubt.start, []).append(doubt)
    return list(by_interval.values())


def between(clip: Clip, doubt: Doubt) -> str:
    """The dates of a doubt's interval: "day 10 to 12"."""
    dates = {scan.time: scan.date for scan in clip.scans}
    first, last = dates[doubt.start], dates[doubt.end]
    return f"{first} to {last.removeprefix('day ') if first.startswith('day ') else last}"
