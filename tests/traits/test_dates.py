"""What moments between two scans are called."""

from __future__ import annotations

import pytest

from gclip import ScanMark
from traits.dates import date_at, day_of

SCANS = (
    ScanMark("a", 0.0, "2020-03-08", 1),
    ScanMark("b", 2.0, "2020-03-10", 1),
    ScanMark("c", 4.0, "day 4", 1),
    ScanMark("d", 8.0, "day 8", 1),
    ScanMark("e", 9.0, "2020-03-08T10:00", 1),
    ScanMark("f", 10.0, "2020-03-08T12:00", 1),
)


@pytest.mark.parametrize(
    ("day", "date"),
    [
        (-1.0, "2020-03-08"),
        (0.0, "2020-03-08"),
        (1.0, "2020-03-09"),
        (1.999, "2020-03-09"),
        (2.0, "2020-03-10"),
        (3.0, "3.0"),  # from a date to "day 4": no rule
        (5.0, "day 5.0"),
        (8.5, "8.5"),
        (9.5, "2020-03-08 11:00"),
        (10.0, "2020-03-08T12:00"),
        (11.0, "2020-03-08T12:00"),
    ],
)
def test_dates(day: float, date: str) -> None:
    assert date_at(SCANS, day) == date


@pytest.mark.parametrize(
    "dates",
    [
        ("", ""),
        ("x", "y"),
        ("day 1", "tag 2"),
        ("9999-12-31", "9999-12-31T25:00"),
        ("2020-01-01T00:00+00:00", "2020-01-02"),  # only one of them names its time zone
        ("a" * 900, "1" * 900),
    ],
)
def test_dates_without_a_rule_are_times(dates: tuple[str, str]) -> None:
    scans = (ScanMark("a", 0.0, dates[0], 1), ScanMark("b", 1.0, dates[1], 1))
    assert date_at(scans, 0.5) == "0.5"
    assert date_at(scans, 1.0) == dates[1]


def test_a_moment_beyond_the_calendar_is_a_time() -> None:
    dates = ("9999-12-30T00:00+23:59", "9999-12-31T23:59-23:59")
    scans = [ScanMark(date, float(k), date, 1) for k, date in enumerate(dates)]
    assert date_at(scans, 0.99) == "1.0"


def test_a_time_is_a_number_a_scan_s_date_or_a_date_between() -> None:
    dated = [ScanMark("a", 0.0, "2024-05-01"), ScanMark("b", 4.0, "2024-05-05")]
    assert day_of(dated, "2024-05-02") == 1.0
    assert day_of(dated, "2024-05-01 12:00") == 0.5
    assert day_of(dated, "3.5") == 3.5
    older = [ScanMark("a", 10.0, "2024-05-01"), ScanMark("b", 14.0, "2024-05-05")]
    assert day_of(older, "2024-05-02") == 11.0, "a clip's times need not begin at 0"
    numbered = [ScanMark("a", 3.0, "day 3"), ScanMark("b", 5.0, "day 5")]
    assert day_of(numbered, "day 5") == 5.0
    for text in ("2024-05-02", "day 4", "nan", "", "2024-13-01"):
        assert day_of(numbered, text) is None
