"""The ways in which people write times: patterns, and what their numbers mean."""

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
    return _calendar("ymd", match) if match else None


def _dated(text: str, form: str, shown: str = "%Y-%m-%d") -> Moment | None:
    """The moment that `text` is in a form of strptime's; None where there is no such date."""
    try:
        moment = datetime.strptime(text, form).replace(tzinfo=UTC)
    except ValueError:
        return None  # 2020-13-40
    return Moment((moment - EPOCH) / timedelta(days=1), f"{moment:{shown}}", dated=True)


def _calendar(order: str, match: re.Match[str]) -> Moment | None:
    """From the groups a, b, c, which are d(ay), m(onth: a number or a name), y(ear) in an order."""
    found = {letter: match[group] for letter, group in zip(order, "abc", strict=False)}
    day, name = found.get("d", "1"), found["m"].lower()
    month = int(name) if name.isdecimal() else MONTHS.get(name, 0)
    if "y" not in found:
        stand_in = LEAP_YEAR if (month, int(day)) == (2, 29) else COMMON_YEAR
        return _dated(f"{stand_in} {month} {day}", "%Y %m %d", "%m-%d")
    clock = [match[unit] for unit in ("hour", "minute", "second") if match[unit]]
    texts = [found["y"], str(month), day, *clock]
    forms = ["%Y" if len(texts[0]) == 4 else "%y", "%m", "%d", "%H", "%M", "%S"]
    shown = "%Y-%m-%d" + ("", "", " %H:%M", " %H:%M:%S")[len(clock)]
    return _dated(" ".join(texts), " ".join(forms[: len(texts)]), shown)


def _by_form(form: str, match: re.Match[str]) -> Moment | None:
    return _dated(" ".join(match.groups("1")), form)


_day_of_year, _calendar_week = partial(_by_form, "%Y %j"), partial(_by_form, "%G %V %u")


def _week_and_day(match: re.Match[str]) -> Moment:
    week, day = int(match["week"]), int(match["day"])
    return Moment(7.0 * week + day, f"week {week} day {day}")


def _unix(match: re.Match[str]) -> Moment:
    moment = EPOCH + timedelta(seconds=int(match[0][:10]))
    days = (moment - EPOCH) / timedelta(days=1)
    return Moment(days, f"{moment:%Y-%m-%d %H:%M:%S}", dated=True)


MONTH_NAMES = (
    "jan january januar januari janvier janv janeiro enero gennaio",
    "feb february februar februari février fevrier févr fevr fev fevereiro febrero febbraio",
    "mar march märz maerz mär mrz mars maart mrt março marco marzo",
    "apr april avril avr abril abr aprile",
    "may mai mei maio mayo maggio",
    "jun june juni juin junho junio giugno",
    "jul july juli juillet juil julho julio luglio",
    "aug august augustus août aout agosto ago",
    "sep sept september septembre setembro septiembre settembre",
    "oct october okt oktober octobre outubro octubre ottobre",
    "nov november novembre novembro noviembre",
    "dec december dez dezember décembre decembre dezembro dic diciembre dicembre",
)
MONTHS = {name: number for number, names in enumerate(MONTH_NAMES, 1) for name in names.split()}
_LETTER, _TH = r"[^\W\d_]", "(?:st|nd|rd|th)?"
_DAY, _MONTH = rf"(?P<a>\d\d?){_TH}", rf"{_LETTER}{{3,10}}"
_YEAR = r"(?:19|20|21)\d\d"
_CLOCK = (
    r"(?:[T_ -]?(?P<hour>[01]\d|2[0-3])[-:_.h]?(?P<minute>[0-5]\d)"
    r"(?:[-:_.m]?(?P<second>[0-5]\d))?Z?)?"
)


def _alone(pattern: str) -> re.Pattern[str]:
    """The pattern between characters that are no digits, in any case."""
    return re.compile(rf"(?<!\d){pattern}(?!\d)", re.IGNORECASE)


_ISO = _alone(rf"(?P<a>{_YEAR})([-_.]?)(?P<b>\d\d)\2(?P<c>\d\d){_CLOCK}")


def _dates(family: str, rank: int, orders: str, pattern: str) -> list[Convention]:
    """A convention for each order in which the groups a, b, c may be day, month and year."""
    words = {"d": "day", "m": "month", "y": "year"}
    compiled = _alone(pattern + _CLOCK * ("y" in orders))
    found = []
    for order in orders.split():
        what = f"dates ({', '.join(words[letter] for letter in order)})"
        found.append(Convention(what, compiled, partial(_calendar, order), rank, family))
    return found


def _numbers(unit: str, days: float, prefixes: str, suffixes: str) -> list[Convention]:
    """Numbers with a label before (DAS10, week 2) or behind (12DAT, 3dpi)."""

    def read(match: re.Match[str]) -> Moment:
        number = float(match["number"])
        return Moment(number * days, f"{unit} {number:.10g}")

    what = f"{unit} numbers"
    return [
        Convention(what, re.compile(pattern, re.IGNORECASE), read, rank, what)
        for rank, pattern in (
            (2, rf"(?<![a-z0-9])(?:{prefixes})[ _.-]?(?P<number>\d+(?:\.\d+)?)"),
            (2, rf"(?<![\d.])(?P<number>\d+(?:\.\d+)?){_TH}[ _-]?(?:{suffixes})(?![a-z0-9])"),
            (WEAK_RANK, rf"(?<=\d)(?:{prefixes})(?P<number>\d+)"),  # P3D12
        )
    ]


# Days after sowing, planting, transplanting, germination, emergence, inoculation, infection.
_DAYS_AFTER = "da[sptgeif]|dp[iagsp]"
_WEEKS_AFTER = "wa[sptgeif]|wp[iagsp]"
_DAYS = "days?(?:old)?|d|tage?|jours?|d[ií]as?|天"
# Words that stand only before the number.
_DAY_WORDS = r"days?[ _-]after[ _-][a-z]+|doy|day[ _-]?of[ _-]?year|jd|j\+?|第"
_WEEKS = f"weeks?|wk|w|wochen?|{_WEEKS_AFTER}"
_HOURS = "hours?|hrs?|h|hp[ig]|ha[igs]"
_ORDINAL = _alone(rf"({_YEAR})[-_. ]?(\d\d\d)")
_WEEK_AND_DAY = re.compile(
    r"(?<![a-z0-9])w(?:eeks?|k)?[ _-]?(?P<week>\d+)[ ._-]?d(?:ays?)?[ _-]?(?P<day>\d+)",
    re.IGNORECASE,
)
_CALENDAR_WEEK = _alone(rf"({_YEAR})[ _-]?(?:w|kw|cw|wk|week)[ _-]?(\d\d?)(?:-?([1-7]))?")
_UNIX = _alone(r"1\d{9}(?:\d{3})?")
CONVENTIONS: tuple[Convention, ...] = (
    Convention("dates", _ISO, partial(_calendar, "ymd"), 0, "iso"),
    Convention("years and weeks", _CALENDAR_WEEK, _calendar_week, 2, "calendar weeks"),
    *_dates("year first", 1, "ymd", rf"(?P<a>{_YEAR})(?P<s>[-_.])(?P<b>\d\d?)(?P=s)(?P<c>\d\d?)"),
    *_dates("year first", 1, "ymd", rf"(?P<a>{_YEAR})年(?P<b>\d\d?)月(?P<c>\d\d?)日?"),
    *_dates("named", 1, "dmy", rf"{_DAY}[-_. ]*(?P<b>{_MONTH})[-_. ]*(?P<c>{_YEAR}|\d\d)"),
    *_dates("named", 1, "mdy", rf"(?P<a>{_MONTH})[-_. ]*(?P<b>\d\d?){_TH}[-_., ]+(?P<c>{_YEAR})"),
    *_dates("named", 1, "ymd", rf"(?P<a>{_YEAR})[-_. ]*(?P<b>{_MONTH})[-_. ]*(?P<c>\d\d?)"),
    *_dates("year", 1, "dmy mdy", rf"(?P<a>\d\d?)(?P<s>[-_. ])(?P<b>\d\d?)(?P=s)(?P<c>{_YEAR})"),
    *_dates("eight digits", 1, "dmy mdy", rf"(?P<a>\d\d)(?P<b>\d\d)(?P<c>{_YEAR})"),
    *_numbers("day", 1.0, f"{_DAYS}|{_DAY_WORDS}|{_DAYS_AFTER}", f"{_DAYS}|{_DAYS_AFTER}"),
    *_numbers("week", 7.0, f"{_WEEKS}|[kc]w", _WEEKS),
    *_numbers("hour", 1 / 24, _HOURS, _HOURS),
    *_numbers("minute", 1 / 1440, "minutes?|mins?", "minutes?|mins?"),
    Convention("weeks and days", _WEEK_AND_DAY, _week_and_day, 1, "weeks and days"),
    *_dates("short", 3, "dmy ymd mdy", r"(?P<a>\d\d?)(?P<s>[-.])(?P<b>\d\d?)(?P=s)(?P<c>\d\d)"),
    *_dates("short", WEAK_RANK, "dmy ymd mdy", r"(?P<a>\d\d)_(?P<b>\d\d)_(?P<c>\d\d)"),
    Convention("unix times", _UNIX, _unix, 3, "unix times"),
    Convention("years and days of the year", _ORDINAL, _day_of_year, WEAK_RANK, "ordinal"),
    *_dates("six digits", WEAK_RANK, "ymd dmy mdy", r"(?P<a>\d\d)(?P<b>\d\d)(?P<c>\d\d)"),
    *_dates(NO_YEAR, WEAK_RANK, "dm", rf"{_DAY}[-_. ]*(?P<b>{_MONTH})(?!{_LETTER})"),
    *_dates(NO_YEAR, WEAK_RANK, "md", rf"(?<!{_LETTER})(?P<a>{_MONTH})[-_. ]*(?P<b>\d\d?)"),
    *_dates(NO_YEAR, WEAK_RANK, "md", r"(?P<a>\d\d?)月(?P<b>\d\d?)日?"),
    *_dates("months", WEAK_RANK, "my", rf"(?P<a>{_MONTH})[-_. ]*(?P<b>{_YEAR})"),
    *_dates("months", WEAK_RANK, "ym", rf"(?P<a>{_YEAR})[-_. ]*(?P<b>{_MONTH})(?!{_LETTER})"),
    *_dates(NO_YEAR, WEAK_RANK + 1, "m", rf"(?<!{_LETTER})(?P<a>{_MONTH})(?!{_LETTER})"),
    *_dates(NO_YEAR, WEAK_RANK + 1, "md dm", r"(?P<a>\d\d)-?(?P<b>\d\d)"),
    *_dates(NO_YEAR, WEAK_RANK + 1, "dm", r"(?P<a>\d\d?)\.(?P<b>\d\d)\.?(?!\.?\d)"),
)
