"""How the player words times."""

import re
from collections.abc import Sequence

from gclip import ScanMark
from traits.dates import date_at as date_at


def elapsed(scans: Sequence[ScanMark], day: float, unit: str) -> str:
    """The time since the first scan: "+3.4 days", or "scan 2.4" where times are only an order;
    "" where the date says as much, "day 3.4".
    """
    if unit == "days":
        since = f"{day - scans[0].time:.1f}"
        said = re.fullmatch(r"\D*(\d+(?:\.\d+)?)", date_at(scans, day))
        return "" if said and f"{float(said[1]):.1f}" == since else f"+{since} days"
    return f"scan {1.0 + day - scans[0].time:.1f}"


def short_dates(dates: Sequence[str]) -> list[str]:
    """The dates without what all of them share and nobody misses: the year of ISO dates."""
    years = {date[:5] for date in dates}
    if len(years) == 1 and all(re.fullmatch(r"\d{4}-\d\d-\d\d.*", date) for date in dates):
        return [date[5:] for date in dates]
    return list(dates)
