"""The clock of the player: the current time in the series, and how playback advances it."""

from bisect import bisect_left, bisect_right
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Self

SPEEDS = (0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
SECONDS_PER_INTERVAL = 2.0  # at speed 1, on average over the series
MIN_SECONDS, MAX_SECONDS = 4.0, 24.0  # duration of the whole series at speed 1
END_PAUSE = 0.8  # seconds for which the clock stops at an end before it starts over or turns back


class AtEnd(StrEnum):
    """How playback continues at the end of the series."""

    LOOP = "loop"
    PING_PONG = "back and forth"
    STOP = "stop"


@dataclass(frozen=True)
class Timeline:
    """An immutable clock over a series of scans; methods that move it return a new clock."""

    times: tuple[float, ...]  #: times of at least two scans, ascending, in the clip's unit
    day: float  #: current time, from times[0] to times[-1]
    playing: bool = False
    speed: float = 1.0  #: playback speed relative to the default, one of SPEEDS
    at_end: AtEnd = AtEnd.LOOP
    backwards: bool = False  #: whether time decreases (`AtEnd.PING_PONG` only)
    end_pause: float = field(default=0.0, compare=False)  #: seconds spent at an end so far

    @classmethod
    def of(cls, times: list[float] | tuple[float, ...]) -> Self:
        """A clock at the first scan."""
        return cls(tuple(times), times[0])

    @property
    def first(self) -> float:
        return self.times[0]

    @property
    def last(self) -> float:
        return self.times[-1]

    @property
    def days_per_second(self) -> float:
        """Playback speed: units of the clip's time per second."""
        seconds = min(max(SECONDS_PER_INTERVAL * (len(self.times) - 1), MIN_SECONDS), MAX_SECONDS)
        return self.speed * (self.last - self.first) / seconds

    @property
    def _ends(self) -> tuple[float, float]:
        """Where the current direction of playback starts and where it ends."""
        returns = self.backwards and self.at_end is AtEnd.PING_PONG
        return (self.last, self.first) if returns else (self.first, self.last)

    def tick(self, seconds: float) -> Self:
        """Advance by wall time; the result does not depend on how the time is split into frames."""
        if not self.playing:
            return self
        start, end = self._ends
        duration = (self.last - self.first) / self.days_per_second  # seconds from start to end
        elapsed = seconds + self.end_pause + abs(self.day - start) / self.days_per_second
        if self.at_end is AtEnd.STOP and elapsed >= duration:
            return replace(self, day=end, playing=False, backwards=False, end_pause=0.0)
        runs, elapsed = divmod(elapsed, duration + END_PAUSE)
        if self.at_end is AtEnd.PING_PONG and runs % 2:
            start, end = end, start
        day = end if elapsed >= duration else start + (end - start) * elapsed / duration
        return replace(
            self,
            day=min(max(day, self.first), self.last),
            backwards=end < start,
            end_pause=max(elapsed - duration, 0.0),
        )

    def played(self) -> Self:
        """Start playback; at the end of the series from the start again, or backwards."""
        if self.day != self._ends[1]:
            return replace(self, playing=True)
        day = self.day if self.at_end is AtEnd.PING_PONG else self.first
        return replace(self, playing=True, day=day, end_pause=0.0, backwards=day == self.last)

    def paused(self) -> Self:
        return replace(self, playing=False, end_pause=0.0)

    def toggled(self) -> Self:
        return self.paused() if self.playing else self.played()

    def at(self, day: float) -> Self:
        """Go to a day, clipped to the series."""
        return replace(self, day=min(max(day, self.first), self.last), end_pause=0.0)

    def moved(self, days: float) -> Self:
        """Pause, and move by some days; negative numbers move back."""
        return self.paused().at(self.day + days)

    def stepped(self, direction: int) -> Self:
        """Pause at the next scan (direction 1) or the previous one (-1)."""
        previous = bisect_left(self.times, self.day) - 1
        scan = bisect_right(self.times, self.day) if direction > 0 else previous
        return self.paused().at(self.times[min(max(scan, 0), len(self.times) - 1)])

    def faster(self, steps: int = 1) -> Self:
        """Increase the speed by steps of SPEEDS; negative numbers decrease it."""
        index = SPEEDS.index(self.speed) + steps
        return replace(self, speed=SPEEDS[min(max(index, 0), len(SPEEDS) - 1)])
