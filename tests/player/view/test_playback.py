"""The clock, whatever the frame rate; and the dates between the scans."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gclip import ScanMark
from player.view.playback import END_PAUSE, SPEEDS, AtEnd, Timeline
from traits.dates import date_at, elapsed, short_dates

TIMES = st.lists(
    st.floats(-1e4, 1e4, allow_nan=False).map(lambda time: round(time, 2)),
    min_size=2, max_size=12, unique=True,
).map(sorted)  # fmt: skip
CLOCKS = st.builds(
    lambda times, share, speed, end: replace(
        Timeline.of(times).at(times[0] + share * (times[-1] - times[0])),
        speed=speed, at_end=end, playing=True,
    ),
    TIMES, st.floats(0, 1), st.sampled_from(SPEEDS), st.sampled_from(AtEnd),
)  # fmt: skip


@given(CLOCKS, st.lists(st.floats(0, 3), max_size=30))
def test_the_day_never_leaves_the_series(clock: Timeline, frames: list[float]) -> None:
    for seconds in frames:
        clock = clock.tick(seconds)
        assert clock.first <= clock.day <= clock.last


@given(CLOCKS, st.integers(1, 240))
def test_the_frame_rate_does_not_matter(clock: Timeline, frames: int) -> None:
    at_once = clock.tick(10.0)
    in_frames = clock
    for _ in range(frames):
        in_frames = in_frames.tick(10.0 / frames)
    span = clock.last - clock.first
    away = abs(at_once.day - in_frames.day)
    # Rounding may let one of the two turn at an end a moment before the other.
    assert min(away, abs(span - away)) <= 1e-6 * max(span, abs(clock.first), abs(clock.last))


def test_half_the_seconds_at_twice_the_speed() -> None:
    clock = Timeline.of([0.0, 1.0, 2.0, 8.0]).played()
    assert clock.faster().tick(1.0).day == pytest.approx(clock.tick(2.0).day)
    assert clock.faster(-1).tick(2.0).day == pytest.approx(clock.tick(1.0).day)


def test_a_stopped_clock_stands() -> None:
    clock = Timeline.of([0.0, 4.0]).at(1.0)
    assert clock.tick(100.0) == clock
    assert clock.played().paused().tick(100.0) == clock


def test_loop_rests_at_the_end_then_starts_over() -> None:
    clock = Timeline.of([0.0, 4.0]).played()  # one day a second
    assert clock.tick(4.0).day == 4.0
    assert clock.tick(4.0 + 0.9 * END_PAUSE).day == 4.0
    assert clock.tick(4.0 + END_PAUSE + 1.0).day == pytest.approx(1.0)


def test_ping_pong_comes_back_the_same_way() -> None:
    clock = replace(Timeline.of([0.0, 4.0]), at_end=AtEnd.PING_PONG).played()
    assert clock.tick(4.0 + END_PAUSE + 1.0).day == pytest.approx(3.0)
    assert clock.tick(8.0 + 2 * END_PAUSE + 1.0).day == pytest.approx(1.0)


def test_stop_stops_and_play_starts_over() -> None:
    clock = replace(Timeline.of([0.0, 4.0]), at_end=AtEnd.STOP).played().tick(60.0)
    assert (clock.day, clock.playing) == (4.0, False)
    assert clock.toggled().tick(1.0).day == pytest.approx(1.0)


def test_play_at_the_end_of_a_loop_starts_over_at_once() -> None:
    assert Timeline.of([0.0, 4.0]).at(4.0).played().tick(1.0).day == pytest.approx(1.0)


@given(TIMES)
def test_steps_visit_every_scan_in_order_and_back(times: list[float]) -> None:
    clock = Timeline.of(times)
    forth = [clock := clock.stepped(1) for _ in times]
    assert [step.day for step in forth] == [*times[1:], times[-1]]
    back = [clock := clock.stepped(-1) for _ in times]
    assert [step.day for step in back] == [*times[-2::-1], times[0]]


def test_a_step_from_between_goes_to_the_neighbours_and_pauses() -> None:
    clock = Timeline.of([0.0, 2.0, 5.0]).played().at(3.0)
    assert (clock.stepped(-1).day, clock.stepped(1).day) == (2.0, 5.0)
    assert not clock.stepped(1).playing


def test_seeking_is_clamped_and_ends_the_rest() -> None:
    clock = Timeline.of([0.0, 4.0]).played()
    assert (clock.at(-3.0).day, clock.at(9.0).day) == (0.0, 4.0)
    assert clock.tick(4.1).at(1.0).tick(0.1).day == pytest.approx(1.1)


def test_speeds_end_where_the_table_ends() -> None:
    clock = Timeline.of([0.0, 1.0])
    for _ in range(20):
        clock = clock.faster()
    assert clock.speed == SPEEDS[-1]
    for _ in range(20):
        clock = clock.faster(-1)
    assert clock.speed == SPEEDS[0]


def marks(*dates: str, times: tuple[float, ...] = (0.0, 2.0)) -> list[ScanMark]:
    return [ScanMark("", time, date, 1) for time, date in zip(times, dates, strict=True)]


@pytest.mark.parametrize(
    ("before", "after", "between"),
    [
        ("2020-03-08", "2020-03-10", "2020-03-09"),
        ("2020-02-28", "2020-03-01", "2020-02-29"),
        ("2020-03-08T10:00", "2020-03-08 22:00", "2020-03-08 16:00"),
        ("day 3", "day 6", "day 4.5"),
        ("0", "1", "0.5"),
        ("D12", "D14.5", "D13.2"),
        ("sown", "harvest", "1.0"),
        ("2020-03-08T10:00+01:00", "2020-03-08T12:00", "1.0"),
        ("%s", "\n", "1.0"),
    ],
)
def test_dates_between_scans_follow_the_scans(before: str, after: str, between: str) -> None:
    scans = marks(before, after)
    assert date_at(scans, 0.0) == before
    assert date_at(scans, 1.0) == between
    assert date_at(scans, 2.0) == after


def test_a_date_outside_the_series_is_the_nearest_scan_s() -> None:
    scans = marks("day 3", "day 6")
    assert (date_at(scans, -1.0), date_at(scans, 9.0)) == ("day 3", "day 6")


def test_elapsed_names_the_unit() -> None:
    scans = marks("a", "b", times=(5.0, 7.0))
    assert elapsed(scans, 6.2, "days") == "+1.2 days"
    assert elapsed(scans, 6.2, "scans") == "scan 2.2"


def test_short_dates_leave_out_only_a_shared_year() -> None:
    assert short_dates(["2020-03-08", "2020-03-10"]) == ["03-08", "03-10"]
    assert short_dates(["2020-12-08", "2021-01-10"]) == ["2020-12-08", "2021-01-10"]
    assert short_dates(["day 3", "day 5"]) == ["day 3", "day 5"]


def test_frames_there_and_back() -> None:
    clock = Timeline.of([0.0, 2.0, 4.0]).at(1.0)
    there = clock.moved(clock.days_per_second / 30)
    assert 0.0 < there.day - 1.0 < 0.1
    assert there.moved(-clock.days_per_second / 30).day == pytest.approx(1.0)
