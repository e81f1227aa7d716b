"""Convert between times and dates in the style of the scans' dates, and format them."""

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
    """Format a time as a date: that of a scan, or one between two scans in the style of theirs.

    Between ISO dates it is an ISO date, between "day 3" and "day 5" a day with one decimal
    ("day 3.4"), and otherwise the time as a number, "3.4".

    Parameters
    ----------
    scans : sequence of gclip.ScanMark
        In the order of time.
    day : float
        In the clip's unit of time.

    Returns
    -------
    str
    """
    index = min(max(bisect_right([scan.time for scan in scans], day) - 1, 0), len(scans) - 1)
    before, after = scans[index], scans[min(index + 1, len(scans) - 1)]
    if day <= before.time or before is after:
        return before.date
    share = (day - before.time) / (after.time - before.time)
    with suppress(ValueError, TypeError, OverflowError):  # no ISO dates, or only one has a zone
        start, end = (datetime.fromisoformat(scan.date) for scan in (before, after))
        style = "%Y-%m-%d %H:%M" if ":" in before.date + after.date else "%Y-%m-%d"
        return (start + share * (end - start)).strftime(style)
    pattern = re.compile(r"(.*?)(-?\d+(?:\.\d+)?)", re.DOTALL)
    first, last = pattern.fullmatch(before.date), pattern.fullmatch(after.date)
    if first and last and first[1] == last[1]:
        return f"{first[1]}{(1.0 - share) * float(first[2]) + share * float(last[2]):.1f}"
    return f"{day:.1f}"


def day_of(scans: Sequence[ScanMark], text: str) -> float | None:
    """Parse the date of a scan, a number or, if the scans have these, an ISO date.

    Parameters
    ----------
    scans : sequence of gclip.ScanMark
        In the order of time.
    text : str

    Returns
    -------
    float or None
        The time in the clip's unit; None if the text is none of these.
    """
    dates = {scan.date: scan.time for scan in scans if scan.date}
    if text in dates:
        return dates[text]
    with suppress(ValueError):
        return float(text) if math.isfinite(float(text)) else None
    with suppress(ValueError, TypeError):  # no ISO dates, or only one has a zone
        since = datetime.fromisoformat(text) - datetime.fromisoformat(scans[0].date)
        return scans[0].time + since / timedelta(days=1)
    return None


def elapsed(scans: Sequence[ScanMark], day: float, unit: str) -> str:
    """Format the time since the first scan as "+3.4 days", or as "scan 2.4" without dates.

    The result is empty if the date itself states that time, such as "day 3.4".
    """
    if unit == "days":
        since = f"{day - scans[0].time:.1f}"
        stated = re.fullmatch(r"\D*(\d+(?:\.\d+)?)", date_at(scans, day))
        return "" if stated and f"{float(stated[1]):.1f}" == since else f"+{since} days"
    return f"scan {1.0 + day - scans[0].time:.1f}"


def short_dates(dates: Sequence[str]) -> list[str]:
    """Remove the year from ISO dates if it is the same in all of them."""
    years = {date[:5] for date in dates}
    if len(years) == 1 and all(re.fullmatch(r"\d{4}-\d\d-\d\d.*", date) for date in dates):
        return [date[5:] for date in dates]
    return list(dates)
