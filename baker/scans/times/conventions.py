"""The ways in which people write times: patterns, and what their numbers mean."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import UTC, date, datetime, timedelta

EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
COMMON_YEAR, LEAP_YEAR = 2001, 2000  # stand in where a name has no year
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

    Attributes
    ----------
    what : str
        For people: "dates (day, month, year)".
    pattern : re.Pattern
    read : callable
        From a match to a moment, or None where the numbers are no such time.
    rank : int
        How readily other numbers are taken for it; lower ranks are preferred.
    family : str
        Conventions of one family differ only in the order of day, month and year.
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


def _dated(moment: datetime, written: str) -> Moment:
    return Moment((moment - EPOCH) / timedelta(days=1), written, dated=True)


def _iso(match: re.Match[str]) -> Moment | None:
    numbers = [int(n) for n in match.group("year", "month", "day", "hour", "minute", "second") if n]
    try:
        moment = datetime(*numbers, tzinfo=UTC)  # type: ignore[arg-type, misc]
    except ValueError:
        return None  # 2020-13-40
    written = moment.strftime("%Y-%m-%d %H:%M:%S")
    return _dated(moment, written[: {3: 10, 5: 16}.get(len(numbers), 19)])


def _calendar(order: str) -> Callable[[re.Match[str]], Moment | None]:
    """Reads the groups first, second, third as d(ay), m(onth), y(ear) in this order."""

    def read(match: re.Match[str]) -> Moment | None:
        groups = ("first", "second", "third")
        texts = {letter: match[group] for letter, group in zip(order, groups, strict=False)}
        year = int(texts["y"]) if "y" in texts else None
        month = texts["m"]
        number = int(month) if month.isdecimal() else MONTHS[month[:3].lower()]
        return _day_of_year(year, number, int(texts["d"]))

    return read


def _day_of_year(year: int | None, month: int, day: int) -> Moment | None:
    stand_in = LEAP_YEAR if (month, day) == (2, 29) else COMMON_YEAR
    full = stand_in if year is None else year + 2000 if year < 100 else year
    try:
        moment = datetime(full, month, day, tzinfo=UTC)
    except ValueError:
        return None
    return _dated(moment, f"{moment:%m-%d}" if year is None else f"{moment:%Y-%m-%d}")


def _ordinal(match: re.Match[str]) -> Moment | None:
    year, number = int(match["year"]), int(match["number"])
    if not 1 <= number <= 366:
        return None
    moment = datetime.combine(date(year, 1, 1) + timedelta(number - 1), datetime.min.time(), UTC)
    return _dated(moment, f"{moment:%Y-%m-%d}")


def _unix(match: re.Match[str]) -> Moment:
    moment = EPOCH + timedelta(seconds=int(match[0][:10]))
    return _dated(moment, f"{moment:%Y-%m-%d %H:%M:%S}")


def _labelled(unit: str, days: float) -> Callable[[re.Match[str]], Moment]:
    def read(match: re.Match[str]) -> Moment:
        number = float(match["number"])
        return Moment(number * days, f"{unit} {number:.10g}")

    return read


MONTHS = {
    name: number
    for number, names in enumerate(
        (
            *("jan", "feb", "mar mär mae mrz", "apr", "may mai", "jun"),
            *("jul", "aug", "sep", "oct okt", "nov", "dec dez"),
        ),
        1,
    )
    for name in names.split()
}
_MONTH = "(?:" + "|".join(MONTHS) + ")[a-zä]{0,6}"
_YEAR = r"(?:19|20|21)\d\d"
_ISO = re.compile(
    rf"""(?<!\d) (?P<year>{_YEAR}) (?P<dash>[-_.]?) (?P<month>\d\d) (?P=dash) (?P<day>\d\d)
        (?: [T_\ -]? (?P<hour>[01]\d|2[0-3]) [-:_.h]? (?P<minute>[0-5]\d)
            (?: [-:_.m]? (?P<second>[0-5]\d) )? Z? )?
        (?!\d)""",
    re.VERBOSE | re.IGNORECASE,
)


def _dates(what: str, pattern: str, rank: int, orders: Sequence[str]) -> list[Convention]:
    """A convention for each order of day, month and year in which numbers may be meant."""
    words = {"d": "day", "m": "month", "y": "year"}
    compiled = re.compile(rf"(?<!\d){pattern}(?!\d)", re.IGNORECASE)
    return [
        Convention(
            f"dates ({', '.join(words[letter] for letter in order)})",
            compiled,
            _calendar(order),
            rank,
            what,
        )
        for order in orders
    ]


def _numbers(unit: str, days: float, prefixes: str, suffixes: str) -> list[Convention]:
    """Numbers with a label before (DAS10, week 2) or behind (12DAT, 3dpi)."""
    patterns = (
        rf"(?<![a-z0-9])(?:{prefixes})[ _.-]?(?P<number>\d+(?:\.\d+)?)",
        rf"(?<![\d.])(?P<number>\d+(?:\.\d+)?)[ _-]?(?:{suffixes})(?![a-z0-9])",
    )
    return [
        Convention(
            f"{unit} numbers",
            re.compile(pattern, re.IGNORECASE),
            _labelled(unit, days),
            2,
            f"{unit} numbers",
        )
        for pattern in patterns
    ]


# Days after sowing, planting, transplanting, germination, emergence, inoculation, infection.
_DAYS_AFTER = "da[sptgeif]|dp[iagsp]"
CONVENTIONS: tuple[Convention, ...] = (
    Convention("dates", _ISO, _iso, 0, "iso"),
    *_dates(
        "year first",
        rf"(?P<first>{_YEAR})(?P<s>[-_.])(?P<second>\d\d?)(?P=s)(?P<third>\d\d?)",
        1,
        ["ymd"],
    ),
    *_dates(
        "named",
        rf"(?P<first>\d\d?)[-_. ]*(?P<second>{_MONTH})[-_. ]*(?P<third>{_YEAR}|\d\d)",
        1,
        ["dmy"],
    ),
    *_dates(
        "named",
        rf"(?P<first>{_MONTH})[-_. ]*(?P<second>\d\d?)[-_., ]+(?P<third>{_YEAR})",
        1,
        ["mdy"],
    ),
    *_dates(
        "named",
        rf"(?P<first>{_YEAR})[-_. ]*(?P<second>{_MONTH})[-_. ]*(?P<third>\d\d?)",
        1,
        ["ymd"],
    ),
    *_dates(
        "numbers and a year",
        rf"(?P<first>\d\d?)(?P<s>[-_. ])(?P<second>\d\d?)(?P=s)(?P<third>{_YEAR})",
        1,
        ["dmy", "mdy"],
    ),
    *_dates(
        "eight digits", rf"(?P<first>\d\d)(?P<second>\d\d)(?P<third>{_YEAR})", 1, ["dmy", "mdy"]
    ),
    *_numbers("day", 1.0, f"days?|d|tage?|dag|{_DAYS_AFTER}", f"days?|d|tage?|{_DAYS_AFTER}"),
    *_numbers("week", 7.0, "weeks?|wk|w|wochen?|kw", "weeks?|wk|w|wochen?"),
    *_numbers("hour", 1 / 24, "hours?|hrs?|h|hp[ig]|ha[igs]", "hours?|hrs?|h|hp[ig]|ha[igs]"),
    *_dates(
        "two-digit numbers",
        r"(?P<first>\d\d?)(?P<s>[-.])(?P<second>\d\d?)(?P=s)(?P<third>\d\d)",
        3,
        ["dmy", "ymd", "mdy"],
    ),
    Convention("unix times", re.compile(r"(?<!\d)1\d{9}(?:\d{3})?(?!\d)"), _unix, 3, "unix times"),
    Convention(
        "years and days of the year",
        re.compile(rf"(?<!\d)(?P<year>{_YEAR})[-_. ]?(?P<number>\d\d\d)(?!\d)"),
        _ordinal,
        WEAK_RANK,
        "days of the year",
    ),
    *_dates(
        "six digits",
        r"(?P<first>\d\d)(?P<second>\d\d)(?P<third>\d\d)",
        WEAK_RANK,
        ["ymd", "dmy", "mdy"],
    ),
    *_dates(
        "month and day", rf"(?P<first>\d\d?)[-_. ]?(?P<second>{_MONTH})(?![a-z])", WEAK_RANK, ["dm"]
    ),
    *_dates("month and day", r"(?P<first>\d\d)-?(?P<second>\d\d)", WEAK_RANK + 1, ["md", "dm"]),
)
