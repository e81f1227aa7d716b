"""What to call a moment between two scans, from how people wrote the scans' dates."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Sequence
from datetime import datetime
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gclip.clip import ScanMark

_NUMBERED = re.compile(r"(.*?)(-?\d+(?:\.\d+)?)", re.DOTALL)


def date_at(scans: Sequence[ScanMark], day: float) -> str:
    """The date of a moment: a scan's own, or one in between written in the way of its neighbours.

    Between ISO dates it is an ISO date, between "day 3" and "day 5" a number with one decimal
    ("day 3.4"); where the dates follow no such rule it is the bare time, "3.4".
    """
    index = min(max(bisect_right([scan.time for scan in scans], day) - 1, 0), len(scans) - 1)
    before, after = scans[index], scans[min(index + 1, len(scans) - 1)]
    if day <= before.time or before is after:
        return before.date
    share = (day - before.time) / (after.time - before.time)
    return (
        _between_moments(before.date, after.date, share)
        or _between_numbers(before.date, after.date, share)
        or f"{day:.1f}"
    )


def _between_moments(before: str, after: str, share: float) -> str:
    try:
        start, end = datetime.fromisoformat(before), datetime.fromisoformat(after)
        moment = start + share * (end - start)
    except (ValueError, TypeError):  # TypeError: only one of the two names its time zone
        return ""
    return f"{moment:%Y-%m-%d %H:%M}" if ":" in before + after else f"{moment:%Y-%m-%d}"


def _between_numbers(before: str, after: str, share: float) -> str:
    start, end = _NUMBERED.fullmatch(before), _NUMBERED.fullmatch(after)
    if not (start and end) or start[1] != end[1]:
        return ""
    return f"{start[1]}{(1.0 - share) * float(start[2]) + share * float(end[2]):.1f}"
