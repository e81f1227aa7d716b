"""Times that people write into the names of scans: dates, and numbers of days, weeks or hours.

A convention is a pattern and what its numbers mean. No name tells alone which one its author had in
mind (``05032023`` is in March or in May), but the names of a series together mostly do: a
convention has to fit all of them, the number has to differ from scan to scan, and of several
possible orders of day, month and year the one is taken that gives the shortest series.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, date, datetime, timedelta
from itertools import pairwise

EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
COMMON_YEAR, LEAP_YEAR = 2001, 2000  # stand in where a name has no year
MAX_GAP_WITHIN_YEAR = 183  # days; a longer gap between dates without a year is a turn of the year
MAX_SPAN = 1100  # days that dates without separators may span: else they are other numbers
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


@dataclass(frozen=True)
class Reading:
    """The times of all names of a series, by one convention.

    Attributes
    ----------
    moments : tuple of Moment
    spans : tuple of (int, int)
        Where in each text the time stands.
    convention : Convention
    doubt : str
        A sentence for people where the times may be read in another way; else empty.
    """

    moments: tuple[Moment, ...]
    spans: tuple[tuple[int, int], ...]
    convention: Convention
    doubt: str = ""

    @property
    def distinct(self) -> bool:
        """Whether no two scans have the same time."""
        return len({moment.time for moment in self.moments}) == len(self.moments)

    @property
    def length(self) -> float:
        """Days from the first to the last."""
        times = [moment.time for moment in self.moments]
        return max(times) - min(times)


def read_times(texts: Sequence[str]) -> Reading | None:
    """Read the times that all texts have.

    Parameters
    ----------
    texts : sequence of str
        For each scan its file's name without suffix, or the name of a folder.

    Returns
    -------
    Reading or None
        The most likely reading in which all times differ; else one in which two scans have the
        same time; None where there is neither.
    """
    readings = [
        reading
        for convention in CONVENTIONS
        for reading in _readings(convention, texts)
        if _is_plausible(reading)
    ]
    distinct = [reading for reading in readings if reading.distinct]
    if not distinct:
        clear = [reading for reading in readings if reading.convention.is_clear]
        return next((reading for reading in clear if not _is_shared(reading, texts)), None)
    best = min(distinct, key=lambda reading: (reading.convention.rank, reading.length))
    others = [
        reading
        for reading in distinct
        if reading.convention.family == best.convention.family
        and reading.moments != best.moments
        and reading.length <= MAX_SPAN
    ]
    return Reading(best.moments, best.spans, best.convention, _doubt(best, others))


def find_time(text: str) -> re.Match[str] | None:
    """The first clearly written time in a text: a date with a year, or a labelled number."""
    for convention in CONVENTIONS:
        if convention.is_clear:
            for match in convention.pattern.finditer(text):
                if convention.read(match) is not None:
                    return match
    return None


def parse_date(text: str) -> Moment | None:
    """A moment from an ISO date or date-time that is the whole text."""
    match = _ISO.fullmatch(text)
    return _iso(match) if match else None


def _readings(convention: Convention, texts: Sequence[str]) -> Iterator[Reading]:
    """One reading for each place, counted from the left, at which all texts have a match."""
    matches = [list(convention.pattern.finditer(text)) for text in texts]
    for place in range(min(map(len, matches), default=0)):
        chosen = [found[place] for found in matches]
        moments = [convention.read(match) for match in chosen]
        known = [moment for moment in moments if moment is not None]
        if len(known) == len(texts):
            if convention.family == "month and day":
                known = _across_new_year(known)
            yield Reading(tuple(known), tuple(match.span() for match in chosen), convention)


def _is_shared(reading: Reading, texts: Sequence[str]) -> bool:
    """Whether all names have one number in common (a plot, a pot) and differ in another one."""
    constant = len({moment.time for moment in reading.moments}) == 1
    rest = {t[:start] + t[stop:] for t, (start, stop) in zip(texts, reading.spans, strict=True)}
    return constant and not reading.moments[0].dated and len(rest) == len(texts)


def _is_plausible(reading: Reading) -> bool:
    """Weak conventions fit counters as well, which seldom give dates of one season."""
    return reading.convention.is_clear or reading.length <= MAX_SPAN


def _doubt(best: Reading, others: Sequence[Reading]) -> str:
    if others:
        other = min(others, key=lambda reading: reading.length)
        return (
            f"{best.convention.what} would also be {other.convention.what}, from "
            f"{min(other.moments, key=lambda m: m.time).date} to "
            f"{max(other.moments, key=lambda m: m.time).date}; --times FILE says which"
        )
    if not best.convention.is_clear:
        return f"the numbers were taken for {best.convention.what}; --times FILE says if not"
    return ""


def _across_new_year(moments: Sequence[Moment]) -> list[Moment]:
    """Dates without a year: those before a gap of half a year belong to the next year."""
    times = sorted({moment.time for moment in moments})
    breaks = [b for a, b in pairwise(times) if b - a > MAX_GAP_WITHIN_YEAR]
    if not breaks:
        return list(moments)
    return [
        moment if moment.time >= breaks[-1] else Moment(moment.time + 365, moment.date, True)
        for moment in moments
    ]


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
