"""Times in names, as people write them: all scans of a series together tell what is meant."""

from datetime import date, timedelta

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from baker.scans.times.names import read_times


def days_of(names):
    reading = read_times(names)
    assert reading is not None
    times = [moment.time for moment in reading.moments]
    return [time - min(times) for time in times]


@pytest.mark.parametrize(
    ("names", "days"),
    [
        (["a_28.02.2023", "a_02.03.2023"], [0, 2]),
        (["a-28-02-2023", "a-02-03-2023"], [0, 2]),
        (["28022023", "02032023"], [0, 2]),
        (["02282023", "03022023"], [0, 2]),
        (["28Feb2023", "2Mar2023"], [0, 2]),
        (["28 Feb 23 top", "02 März 23 top"], [0, 2]),
        (["Feb 28, 2023", "Mar 02, 2023"], [0, 2]),
        (["28.2.23", "2.3.23"], [0, 2]),
        (["230228", "230302"], [0, 2]),
        (["2023-2-28", "2023-3-2"], [0, 2]),
        (["M01_0228", "M01_0302"], [0, 2]),
        (["M01_0228_a", "M01_0302"], [0, 2]),
        (["1231", "0102"], [0, 2]),
        (["02-28", "03-02"], [0, 2]),
        (["28Feb", "02Mar"], [0, 2]),
        (["2023_059", "2023_061"], [0, 2]),
        (["1677542400", "1677715200"], [0, 2]),
        (["DAS9", "DAS11"], [0, 2]),
        (["9DAT", "11DAT"], [0, 2]),
        (["p_9dpi", "p_11dpi"], [0, 2]),
        (["DAI9", "DAI11"], [0, 2]),
        (["Tag 9", "Tag 11"], [0, 2]),
        (["Day-9", "Day-11"], [0, 2]),
        (["week2", "week10"], [0, 56]),
        (["3w", "4w"], [0, 7]),
        (["h000", "h036"], [0, 1.5]),
        (["pot_D2_day9", "pot_D2_day11"], [0, 2]),
        (["D1_2023-02-28", "D1_2023-03-02"], [0, 2]),
        (["p_w1d3", "p_w2d1"], [0, 5]),
        (["27.02", "01.03", "05.03"], [0, 2, 6]),
        (["March 5", "March 9"], [0, 4]),
        (["9. März", "5. März"], [4, 0]),
        (["jour 3", "jour 10"], [0, 7]),
        (["30min", "60min"], [0, 1 / 48]),
        (["2023-02-28T06-00_1", "2023-03-02T18-00_1"], [0, 2.5]),
        (["28022023_0600", "02032023_1800"], [0, 2.5]),
        (["2302280600", "2303021800"], [0, 2.5]),
        (["28 février 2023", "2 mars 2023"], [0, 2]),
        (["28 februari 2023", "2 maart 2023"], [0, 2]),
        (["28th Feb 2023", "2nd March 2023"], [0, 2]),
        (["28_02_23", "02_03_23"], [0, 2]),
        (["2023年2月28日", "2023年3月2日"], [0, 2]),
        (["2月28日", "3月2日"], [0, 2]),
        (["第9天", "第11天"], [0, 2]),
        (["2022_KW52", "2023_KW01"], [0, 7]),
        (["2023-W09-2", "2023-W09-4"], [0, 2]),
        (["Feb2023", "Mar2023"], [0, 28]),
        (["Apr", "Mar"], [31, 0]),
        (["2wpi", "4wpi"], [0, 14]),
        (["W1.D3", "W2.D1"], [0, 5]),
        (["J3", "J10"], [0, 7]),
        (["9daysold", "11daysold"], [0, 2]),
        (["day_after_sowing_9", "day_after_sowing_11"], [0, 2]),
        (["P3D9", "P3D11"], [0, 2]),
        (["20230228_edited_20240101", "20230302_edited_20240107"], [0, 2]),
    ],
)
def test_what_people_write(names, days):
    assert days_of(names) == pytest.approx(days)


@pytest.mark.parametrize(
    "names",
    [
        ["a", "b"],
        ["scan1", "scan2"],
        ["s3D_1", "s3D_2"],
        ["2020-13-40", "2020-14-50"],
        ["v1.5", "v1.6"],
        ["maize1", "maize2"],
        ["marie 3", "marie 4"],
    ],
)
def test_numbers_that_are_no_times(names):
    assert read_times(names) is None


FORMATS = [
    *("{0:%Y-%m-%d}", "{0:%Y%m%d}", "{0:%d.%m.%Y}", "{0:%d%b%Y}", "{0.day}.{0.month}.{0.year}"),
    *("{0:%d%m%Y}", "{0:%m%d%Y}", "{0:%m-%d-%Y}", "{0.year}-{0.month}-{0.day}", "{0:%Y-%j}"),
]


@given(
    st.sampled_from(FORMATS),
    st.dates(date(2001, 1, 1), date(2080, 1, 1)),
    st.sets(st.integers(1, 60), min_size=2, max_size=8),
)
def test_a_series_of_dates_has_its_true_gaps_or_a_doubt(form, first, after):
    days = [0, *sorted(after)]
    names = [f"plant_{form.format(first + timedelta(days=day))}_x" for day in days]
    reading = read_times(names)
    assert reading is not None
    assert days_of(names) == days or reading.doubt


@given(st.dates(date(2001, 1, 1), date(2080, 1, 1)))
def test_the_order_of_names_does_not_matter(first):
    names = [f"{first + timedelta(days=k):%d%m%Y}" for k in (0, 3, 9)]
    assume(len({name[:2] for name in names}) == 3)
    assert days_of(names[::-1]) == days_of(names)[::-1]


def test_an_ambiguous_order_is_said():
    reading = read_times(["01.02.2023", "03.02.2023", "05.02.2023"])
    assert reading is not None
    assert "dates, 2023-01-02 to 2023-05-02" in reading.doubt


def test_a_single_date_that_can_be_read_in_two_ways_is_in_doubt():
    reading = read_times(["03-04-2020"])
    assert "2020-0" in reading.doubt


def test_a_leap_day_without_a_year_is_a_date():
    assert days_of(["M01_0228", "M01_0229", "M01_0302"]) == [0, 1, 3]


def test_another_number_that_would_give_another_order_is_said():
    reading = read_times(["D2_2023-03-01", "D1_2023-03-05"])
    assert reading is not None
    assert days_of(["D2_2023-03-01", "D1_2023-03-05"]) == [0, 4]
    assert "day numbers" in reading.doubt
