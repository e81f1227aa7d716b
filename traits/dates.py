"""What to call a moment between two scans, from how people wrote the scans' dates."""

from __future__ import annotations

import math
import re
from bisect import bisect_right
from collections.abc import Sequence
from contextlib import suppress
from datetime import datetime, timedelta
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gclip import ScanMark


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
    with suppress(ValueError, TypeError, OverflowError):  # no ISO dates, or one without its zone
        start, end = (datetime.fromisoformat(scan.date) for scan in (before, after))
        style = "%Y-%m-%d %H:%M" if ":" in before.date + after.date else "%Y-%m-%d"
        return (start + share * (end - start)).strftime(style)
    numbered = re.compile(r"(.*?)(-?\d+(?:\.\d+)?)", re.DOTALL)
    first, last = numbered.fullmatch(before.date), numbered.fullmatch(after.date)
    if first and last and first[1] == last[1]:
        return f"{first[1]}{(1.0 - share) * float(first[2]) + share * float(last[2]):.1f}"
    return f"{day:.1f}"


def day_of(scans: Sequence[ScanMark], text: str) -> float | None:
    """The time that a text means: a number, a scan's own date, or an ISO date among theirs.

    None where it means none.
    """
    dates = {scan.date: scan.time for scan in scans if scan.date}
    if text in dates:
        return dates[text]
    with suppress(ValueError):
        return float(text) if math.isfinite(float(text)) else None
    with suppress(ValueError, TypeError):  # no ISO dates, or one without its zone
        since = datetime.fromisoformat(text) - datetime.fromisoformat(scans[0].date)
        return scans[0].time + since / timedelta(days=1)
    return None
