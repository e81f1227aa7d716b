"""The ways in which people write times: patterns, and what their numbers mean."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from functools import partial

EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
COMMON_YEAR, LEAP_YEAR = 2001, 2000  # stand in where a name has no year
NO_YEAR = "month and day"  # the family of dates without a year
WEAK_RANK = 4  # conventions from this rank on also fit numbers that are no times


@dataclass(frozen=True)
class Moment:
    """A time in days (since 1970 where `dated`), and the same as people write it."""

    time: float
    date: str
    dated: bool = False


@dataclass(frozen=True)
class Convention:
    """One way to write a time.

    what:    for people: "dates (day, month, year)".
    pattern: what to look for in a name.
    read:    from a match to a moment, or None where the numbers are no such time.
    rank:    how readily other numbers are taken for it; lower ranks are preferred.
    family:  conventions of one family differ only in the order of day, month and year.
    """

    what: str
    pattern: re.Pattern[str]
    read: Callable[[re.Match[str]], Moment | None]
    rank: int
    family: str

    @property
    def is_clear(self) -> bool:
        """Whether hardly any number that is no time fits it."""
        return self.rank < WEAK_RANK


def parse_date(text: str) -> Moment | None:
    """A moment from an ISO date or date-time that is the whole text."""
    match = _ISO.fullmatch(text)
    return _iso(match) if match else None


def _dated(form: str, seconds_after: int = 0, **parts: int) -> Moment | None:
    """The moment so long after these parts of a datetime; None where there is no such date."""
    try:
        moment = datetime(**parts, tzinfo=UTC) + timedelta(seconds=seconds_after)
    except ValueError:
        return None  # 2020-13-40
    return Moment((moment - EPOCH) / timedelta(days=1), f"{moment:{form}}", dated=True)


def _iso(match: re.Match[str]) -> Moment | None:
    parts = {part: int(number) for part, number in match.groupdict().items() if number}
    time = " %H:%M:%S" if "second" in parts else " %H:%M" if "hour" in parts else ""
    return _dated("%Y-%m-%d" + time, **parts)


def _calendar(order: str, match: re.Match[str]) -> Moment | None:
    """From the groups a, b, c, which are d(ay), m(onth: a number or a name), y(ear) in an order."""
    texts = {letter: match[group] for letter, group in zip(order, "abc", strict=False)}
    day, name = int(texts["d"]), texts["m"]
    month = int(name) if name.isdecimal() else MONTHS[name[:3].lower()]
    if "y" not in texts:
        stand_in = LEAP_YEAR if (month, day) == (2, 29) else COMMON_YEAR
        return _dated("%m-%d", year=stand_in, month=month, day=day)
    year = int(texts["y"])
    return _dated("%Y-%m-%d", year=year + 2000 * (year < 100), month=month, day=day)


def _day_of_year(match: re.Match[str]) -> Moment | None:
    number = int(match["number"])
    if not 1 <= number <= 366:
        return None
    return _dated("%Y-%m-%d", (number - 1) * 86400, year=int(match["year"]), month=1, day=1)


def _week_and_day(match: re.Match[str]) -> Moment:
    week, day = int(match["week"]), int(match["day"])
    return Moment(7.0 * week + day, f"week {week} day {day}")


def _unix(match: re.Match[str]) -> Moment | None:
    return _dated("%Y-%m-%d %H:%M:%S", int(match[0][:10]), year=1970, month=1, day=1)


MONTH_NAMES = "jan feb mar,mär,mae,mrz apr may,mai jun jul aug sep oct,okt nov dec,dez"
MONTHS = {
    name: number for number, names in enumerate(MONTH_NAMES.split(), 1) for name in names.split(",")
}
_MONTH = "(?:" + "|".join(MONTHS) + ")[a-zä]{0,6}"
_YEAR = r"(?:19|20|21)\d\d"
_ISO = re.compile(
    rf"""(?<!\d) (?P<year>{_YEAR}) ([-_.]?) (?P<month>\d\d) \2 (?P<day>\d\d)
        (?: [T_\ -]? (?P<hour>[01]\d|2[0-3]) [-:_.h]? (?P<minute>[0-5]\d)
            (?: [-:_.m]? (?P<second>[0-5]\d) )? Z? )?
        (?!\d)""",
    re.VERBOSE | re.IGNORECASE,
)


def _dates(family: str, rank: int, orders: str, pattern: str) -> list[Convention]:
    """A convention for each order in which the groups a, b, c may be day, month and year."""
    words = {"d": "day", "m": "month", "y": "year"}
    compiled = re.compile(rf"(?<!\d){pattern}(?!\d)", re.IGNORECASE)
    return [
        Convention(
            f"dates ({', '.join(words[letter] for letter in order)})",
            compiled,
            partial(_calendar, order),
            rank,
            family,
        )
        for order in orders.split()
    ]


def _numbers(unit: str, days: float, prefixes: str, suffixes: str) -> list[Convention]:
    """Numbers with a label before (DAS10, week 2) or behind (12DAT, 3dpi)."""

    def read(match: re.Match[str]) -> Moment:
        number = float(match["number"])
        return Moment(number * days, f"{unit} {number:.10g}")

    what = f"{unit} numbers"
    return [
        Convention(what, re.compile(pattern, re.IGNORECASE), read, 2, what)
        for pattern in (
            rf"(?<![a-z0-9])(?:{prefixes})[ _.-]?(?P<number>\d+(?:\.\d+)?)",
            rf"(?<![\d.])(?P<number>\d+(?:\.\d+)?)[ _-]?(?:{suffixes})(?![a-z0-9])",
        )
    ]


# Days after sowing, planting, transplanting, germination, emergence, inoculation, infection.
_DAYS_AFTER = "da[sptgeif]|dp[iagsp]"
_DAYS = "days?|d|tage?|jours?|d[ií]as?"
_HOURS = "hours?|hrs?|h|hp[ig]|ha[igs]"
_ORDINAL = re.compile(rf"(?<!\d)(?P<year>{_YEAR})[-_. ]?(?P<number>\d\d\d)(?!\d)")
_WEEK_AND_DAY = re.compile(
    r"(?<![a-z0-9])w(?:eeks?|k)?[ _-]?(?P<week>\d+)[ _-]?d(?:ays?)?[ _-]?(?P<day>\d+)",
    re.IGNORECASE,
)
_UNIX = re.compile(r"(?<!\d)1\d{9}(?:\d{3})?(?!\d)")
CONVENTIONS: tuple[Convention, ...] = (
    Convention("dates", _ISO, _iso, 0, "iso"),
    *_dates("year first", 1, "ymd", rf"(?P<a>{_YEAR})(?P<s>[-_.])(?P<b>\d\d?)(?P=s)(?P<c>\d\d?)"),
    *_dates("named", 1, "dmy", rf"(?P<a>\d\d?)[-_. ]*(?P<b>{_MONTH})[-_. ]*(?P<c>{_YEAR}|\d\d)"),
    *_dates("named", 1, "mdy", rf"(?P<a>{_MONTH})[-_. ]*(?P<b>\d\d?)[-_., ]+(?P<c>{_YEAR})"),
    *_dates("named", 1, "ymd", rf"(?P<a>{_YEAR})[-_. ]*(?P<b>{_MONTH})[-_. ]*(?P<c>\d\d?)"),
    *_dates("year", 1, "dmy mdy", rf"(?P<a>\d\d?)(?P<s>[-_. ])(?P<b>\d\d?)(?P=s)(?P<c>{_YEAR})"),
    *_dates("eight digits", 1, "dmy mdy", rf"(?P<a>\d\d)(?P<b>\d\d)(?P<c>{_YEAR})"),
    *_numbers("day", 1.0, f"{_DAYS}|dag|doy|{_DAYS_AFTER}", f"{_DAYS}|{_DAYS_AFTER}"),
    *_numbers("week", 7.0, "weeks?|wk|w|wochen?|kw", "weeks?|wk|w|wochen?"),
    *_numbers("hour", 1 / 24, _HOURS, _HOURS),
    *_numbers("minute", 1 / 1440, "minutes?|mins?", "minutes?|mins?"),
    Convention("weeks and days", _WEEK_AND_DAY, _week_and_day, 1, "weeks and days"),
    *_dates("short", 3, "dmy ymd mdy", r"(?P<a>\d\d?)(?P<s>[-.])(?P<b>\d\d?)(?P=s)(?P<c>\d\d)"),
    Convention("unix times", _UNIX, _unix, 3, "unix times"),
    Convention("years and days of the year", _ORDINAL, _day_of_year, WEAK_RANK, "ordinal"),
    *_dates("six digits", WEAK_RANK, "ymd dmy mdy", r"(?P<a>\d\d)(?P<b>\d\d)(?P<c>\d\d)"),
    *_dates(NO_YEAR, WEAK_RANK, "dm", rf"(?P<a>\d\d?)[-_. ]*(?P<b>{_MONTH})(?![a-z])"),
    *_dates(NO_YEAR, WEAK_RANK, "md", rf"(?P<a>{_MONTH})[-_. ]*(?P<b>\d\d?)"),
    *_dates(NO_YEAR, WEAK_RANK + 1, "md dm", r"(?P<a>\d\d)-?(?P<b>\d\d)"),
    *_dates(NO_YEAR, WEAK_RANK + 1, "dm", r"(?P<a>\d\d?)\.(?P<b>\d\d)\.?(?!\.?\d)"),
)
