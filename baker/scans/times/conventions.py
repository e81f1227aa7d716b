"""Conventions for writing dates and times: regular expressions, and how to read their matches.

A named group of a pattern is a directive of `strptime` (``d``, ``j``, ...; ``m`` may also be the
name of a month), a unit of `DAYS`, or ``unix`` seconds.
"""

import re
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
DAYS = {"week": 7.0, "day": 1.0, "hour": 1 / 24, "minute": 1 / 1440}  # in a unit of time
DATES = "dates"  # the kind of conventions of calendar dates
WEAK_RANK = 4  # conventions of this rank and above also match numbers that are not times


@dataclass(frozen=True)
class Moment:
    """The time of a scan."""

    time: float  # in days; since 1970 if `dated`
    date: str  # the time as text
    dated: bool = False


@dataclass(frozen=True)
class Convention:
    """A notation of times."""

    rank: int  # how easily it matches numbers that are not times; lower ranks are preferred
    kind: str  # what it reads, for messages: "dates", "day numbers"
    pattern: re.Pattern[str]  # to search names for

    @property
    def is_clear(self) -> bool:
        """Whether it hardly ever matches a number that is not a time."""
        return self.rank < WEAK_RANK


def read_moment(match: re.Match[str], default_year: str) -> Moment | None:
    """The moment that a match of a convention's pattern denotes; None if there is no such date."""
    directives = {name: text for name, text in match.groupdict().items() if text and name != "sep"}
    if numbers := {unit: float(directives[unit]) for unit in DAYS if unit in directives}:
        days = sum(number * DAYS[unit] for unit, number in numbers.items())
        return Moment(days, " ".join(f"{unit} {n:.10g}" for unit, n in numbers.items()))
    if "unix" in directives:
        return _dated(EPOCH + timedelta(seconds=int(directives["unix"])), "%Y-%m-%d %H:%M:%S")
    date_format = "%Y-%m-%d" + " %H:%M" * ("H" in directives) + ":%S" * ("S" in directives)
    if "m" in directives:
        name = directives["m"].lower()
        directives["m"] = name if name.isdecimal() else str(MONTHS.get(name, 0))
        directives.setdefault("d", "1")
        if not {"Y", "y"} & directives.keys():
            directives["Y"], date_format = default_year, "%m-%d"
    if "V" in directives:
        directives.setdefault("u", "1")
    codes = " ".join(f"%{directive}" for directive in directives)
    try:
        moment = datetime.strptime(" ".join(directives.values()), codes).replace(tzinfo=UTC)
    except ValueError:
        return None  # as 2020-13-40
    return _dated(moment, date_format)


def _dated(moment: datetime, date_format: str) -> Moment:
    return Moment((moment - EPOCH) / timedelta(days=1), f"{moment:{date_format}}", dated=True)


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
LETTER = r"[^\W\d_]"
FIELDS = {
    "Y": r"(?P<Y>(?:19|20|21)\d\d)",
    "y": r"(?P<y>\d\d)",
    "m": r"(?P<m>\d\d?)",
    "mm": r"(?P<m>\d\d)",
    "d": r"(?P<d>\d\d?)",
    "dd": r"(?P<d>\d\d)",
    "name": rf"(?P<m>{LETTER}{{3,10}})",
    "no_letter": rf"(?!{LETTER})",
    "after_no_letter": rf"(?<!{LETTER})",
    "th": "(?:st|nd|rd|th)?",
    "clock": r"(?:[T_ -]?(?P<H>[01]\d|2[0-3])[-:_.h]?(?P<M>[0-5]\d)"
    r"(?:[-:_.m]?(?P<S>[0-5]\d))?Z?)?",
    "week_of_year": r"(?P<G>(?:19|20|21)\d\d)[ _-]?(?:w|kw|cw|wk|week)[ _-]?(?P<V>\d\d?)",
    "week_and_day": r"w(?:eeks?|k)?[ _-]?(?P<week>\d+)[ ._-]?d(?:ays?)?[ _-]?(?P<day>\d+)",
}


def _convention(rank: int, kind: str, template: str) -> Convention:
    """A convention whose pattern is a template, filled in with `FIELDS`, between non-digits."""
    pattern = rf"(?<!\d){template.format(**FIELDS)}(?!\d)"
    return Convention(rank, kind, re.compile(pattern, re.IGNORECASE))


def _numbers(unit: str, prefixes: str, suffixes: str) -> list[Convention]:
    """Conventions of numbers with a unit before (DAS10, week 2) or after them (12DAT, 3dpi)."""
    number = rf"(?P<{unit}>\d+(?:\.\d+)?)"
    patterns = (
        (2, rf"(?<![a-z0-9])(?:{prefixes})[ _.-]?{number}"),
        (2, rf"(?<![\d.]){number}{FIELDS['th']}[ _-]?(?:{suffixes})(?![a-z0-9])"),
        (WEAK_RANK, rf"(?<=\d)(?:{prefixes})(?P<{unit}>\d+)"),  # P3D12
    )
    return [Convention(r, f"{unit} numbers", re.compile(p, re.IGNORECASE)) for r, p in patterns]


# Days after sowing, planting, transplanting, germination, emergence, inoculation, infection.
_DAYS = "days?(?:old)?|d|tage?|jours?|d[ií]as?|天|da[sptgeif]|dp[iagsp]"
# Words that are written only before the number.
_DAY_WORDS = r"days?[ _-]after[ _-][a-z]+|doy|day[ _-]?of[ _-]?year|jd|j\+?|第"
_WEEKS = "weeks?|wk|w|wochen?|wa[sptgeif]|wp[iagsp]"
_HOURS = "hours?|hrs?|h|hp[ig]|ha[igs]"
CONVENTIONS = (
    _convention(0, DATES, r"{Y}(?P<sep>[-_.]?){mm}(?P=sep){dd}{clock}"),
    _convention(1, DATES, r"{Y}(?P<sep>[-_.]){m}(?P=sep){d}{clock}"),
    _convention(1, DATES, r"{Y}年{m}月{d}日?{clock}"),
    _convention(1, DATES, r"{d}{th}[-_. ]*{name}[-_. ]*(?:{Y}|{y}){clock}"),
    _convention(1, DATES, r"{name}[-_. ]*{d}{th}[-_., ]+{Y}{clock}"),
    _convention(1, DATES, r"{Y}[-_. ]*{name}[-_. ]*{d}{clock}"),
    _convention(1, DATES, r"{d}(?P<sep>[-_. ]){m}(?P=sep){Y}{clock}"),
    _convention(1, DATES, r"{m}(?P<sep>[-_. ]){d}(?P=sep){Y}{clock}"),
    _convention(1, DATES, r"{dd}{mm}{Y}{clock}"),
    _convention(1, DATES, r"{mm}{dd}{Y}{clock}"),
    _convention(1, "weeks and days", r"(?<![a-z0-9]){week_and_day}"),
    _convention(2, "years and weeks", r"{week_of_year}(?:-?(?P<u>[1-7]))?"),
    *_numbers("day", f"{_DAYS}|{_DAY_WORDS}", _DAYS),
    *_numbers("week", f"{_WEEKS}|[kc]w", _WEEKS),
    *_numbers("hour", _HOURS, _HOURS),
    *_numbers("minute", "minutes?|mins?", "minutes?|mins?"),
    _convention(3, DATES, r"{d}(?P<sep>[-.]){m}(?P=sep){y}{clock}"),
    _convention(3, DATES, r"{y}(?P<sep>[-.]){m}(?P=sep){dd}{clock}"),
    _convention(3, DATES, r"{m}(?P<sep>[-.]){d}(?P=sep){y}{clock}"),
    _convention(3, "unix times", r"(?P<unix>1\d{{9}})(?:\d{{3}})?"),
    _convention(WEAK_RANK, "years and days of the year", r"{Y}[-_. ]?(?P<j>\d\d\d)"),
    _convention(WEAK_RANK, DATES, "{dd}(?P<sep>_?){mm}(?P=sep){y}{clock}"),
    _convention(WEAK_RANK, DATES, "{y}(?P<sep>_?){mm}(?P=sep){dd}{clock}"),
    _convention(WEAK_RANK, DATES, "{mm}(?P<sep>_?){dd}(?P=sep){y}{clock}"),
    _convention(WEAK_RANK, DATES, r"{d}{th}[-_. ]*{name}{no_letter}"),
    _convention(WEAK_RANK, DATES, r"{after_no_letter}{name}[-_. ]*{d}"),
    _convention(WEAK_RANK, DATES, "{m}月{d}日?"),
    _convention(WEAK_RANK, DATES, r"{name}[-_. ]*{Y}{clock}"),
    _convention(WEAK_RANK, DATES, r"{Y}[-_. ]*{name}{no_letter}{clock}"),
    _convention(WEAK_RANK + 1, DATES, r"{after_no_letter}{name}{no_letter}"),
    _convention(WEAK_RANK + 1, DATES, "{mm}-?{dd}"),
    _convention(WEAK_RANK + 1, DATES, "{dd}-?{mm}"),
    _convention(WEAK_RANK + 1, DATES, r"{d}\.{mm}\.?(?!\.?\d)"),
)
