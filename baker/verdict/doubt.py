"""Doubts about organs in the intervals of a clip, and the sentence that sums them up."""

import shlex
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from gclip import Clip
from traits.doubts import Doubt

MIN_SHARE = 0.03  # of a scan's points: smaller organs aren't judged (docs/method.md, "The verdict")
MAX_INTERVALS_NAMED, MAX_DOUBTS_NAMED = 3, 2  # in the sentence; doubts of each interval


def verdict_provenance(clip: Clip, doubts: Sequence[Doubt]) -> dict[str, Any]:
    """The verdict as an entry of the clip's provenance (docs/format.md)."""
    return {"line": describe_verdict(clip, doubts), "doubts": [asdict(doubt) for doubt in doubts]}


def describe_verdict(clip: Clip, doubts: Sequence[Doubt]) -> str:
    """Say in a sentence how many intervals look right, and what is wrong in the most doubtful."""
    by_interval = group_by_interval(doubts)
    clauses = []
    for group in sorted(by_interval[:MAX_INTERVALS_NAMED], key=lambda group: group[0].start):
        # Two organs that may be mixed up are two doubts with the same clause.
        what = list(dict.fromkeys(doubt.what for doubt in group))
        named, unnamed = what[:MAX_DOUBTS_NAMED], len(what) - MAX_DOUBTS_NAMED
        named += [f"and {unnamed} more"] * (unnamed > 0)
        clauses.append(f"{interval_dates(clip, group[0])}: {', '.join(named)}")
    if unnamed := len(by_interval) - len(clauses):
        clauses.append(f"and {unnamed} more interval{'s' * (unnamed > 1)}")
    return "; ".join([headline(clip, doubts), *clauses]) + "."


def headline(clip: Clip, doubts: Sequence[Doubt]) -> str:
    """Say in a clause how many intervals look right: "7 of 8 intervals look right"."""
    count, wrong = len(clip.intervals), len(group_by_interval(doubts))
    if count == 1:
        return "The interval does not look right" if wrong else "The interval looks right"
    if not wrong:
        return f"All {count} intervals look right"
    return f"{count - wrong or 'None'} of {count} intervals look{'s' * (count - wrong < 2)} right"


def command_for(doubt: Doubt, path: str | Path) -> str:
    """The shell command that plays the clip at `path` from the middle of a doubtful interval."""
    return f"play {shlex.quote(str(path))} --day {(doubt.start + doubt.end) / 2:.10g}"


def group_by_interval(doubts: Sequence[Doubt]) -> list[list[Doubt]]:
    """Group the doubts by interval; groups, and doubts in a group, are sorted by strength."""
    by_interval: dict[float, list[Doubt]] = {}
    for doubt in sorted(doubts, key=lambda doubt: -doubt.strength):
        by_interval.setdefault(doubt.start, []).append(doubt)
    return list(by_interval.values())


def interval_dates(clip: Clip, doubt: Doubt) -> str:
    """The dates of a doubt's interval, such as "day 10 to 12"."""
    dates = {scan.time: scan.date for scan in clip.scans}
    first, last = dates[doubt.start], dates[doubt.end]
    return f"{first} to {last.removeprefix('day ') if first.startswith('day ') else last}"
