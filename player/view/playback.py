"""The clock of the player: where in the series it stands and how it goes on. No graphics."""

from bisect import bisect_left, bisect_right
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Self

SPEEDS = (0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
SECONDS_PER_INTERVAL = 2.0  # at speed 1, on average over the series
SHORTEST, LONGEST = 4.0, 24.0  # seconds that a whole series takes at speed 1
REST = 0.8  # seconds to look at an end before the clock goes on


class AtEnd(StrEnum):
    """What the clock does at the end of the series."""

    LOOP = "loop"
    PING_PONG = "back and forth"
    STOP = "stop"


@dataclass(frozen=True)
class Timeline:
    """A clock over a series of scans; every move gives a new one."""

    times: tuple[float, ...]  #: the scans' times, ascending, at least two, in the clip's unit
    day: float  #: where the clock stands, from times[0] to times[-1]
    playing: bool = False
    speed: float = 1.0  #: factor on the natural speed, one of SPEEDS
    at_end: AtEnd = AtEnd.LOOP
    backwards: bool = False  #: on its way back (PING_PONG)
    rest: float = field(default=0.0, compare=False)  #: seconds that the clock has waited at an end

    @classmethod
    def of(cls, times: list[float] | tuple[float, ...]) -> Self:
        """A clock that stands at the first scan."""
        return cls(tuple(times), times[0])

    @property
    def first(self) -> float:
        return self.times[0]

    @property
    def last(self) -> float:
        return self.times[-1]

    @property
    def days_per_second(self) -> float:
        """How fast the clock goes, in the clip's unit of time."""
        seconds = min(max(SECONDS_PER_INTERVAL * (len(self.times) - 1), SHORTEST), LONGEST)
        return self.speed * (self.last - self.first) / seconds

    @property
    def _ends(self) -> tuple[float, float]:
        """The days that the clock comes from, and goes to."""
        returns = self.backwards and self.at_end is AtEnd.PING_PONG
        return (self.last, self.first) if returns else (self.first, self.last)

    def tick(self, seconds: float) -> Self:
        """Let wall time pass: however it is cut into frames, the clock arrives at the same day."""
        if not self.playing:
            return self
        start, goal = self._ends
        duration = (self.last - self.first) / self.days_per_second  # seconds from end to end
        passed = seconds + self.rest + abs(self.day - start) / self.days_per_second  # since `start`
        if self.at_end is AtEnd.STOP and passed >= duration:
            return replace(self, day=goal, playing=False, backwards=False, rest=0.0)
        turns, passed = divmod(passed, duration + REST)
        if self.at_end is AtEnd.PING_PONG and turns % 2:
            start, goal = goal, start
        day = goal if passed >= duration else start + (goal - start) * passed / duration
        return replace(
            self,
            day=min(max(day, self.first), self.last),
            backwards=goal < start,
            rest=max(passed - duration, 0.0),
        )

    def played(self) -> Self:
        """Start the clock; at the end of the series it starts over, or goes back."""
        if self.day != self._ends[1]:
            return replace(self, playing=True)
        day = self.day if self.at_end is AtEnd.PING_PONG else self.first
        return replace(self, playing=True, day=day, rest=0.0, backwards=day == self.last)

    def paused(self) -> Self:
        return replace(self, playing=False, rest=0.0)

    def toggled(self) -> Self:
        return self.paused() if self.playing else self.played()

    def at(self, day: float) -> Self:
        """Go to a day; days outside the series give its first or last one."""
        return replace(self, day=min(max(day, self.first), self.last), rest=0.0)

    def moved(self, days: float) -> Self:
        """Pause and go on by some days, negative for back."""
        return self.paused().at(self.day + days)

    def stepped(self, direction: int) -> Self:
        """Pause at the next scan (direction 1) or the one before (-1)."""
        behind = bisect_left(self.times, self.day) - 1
        scan = bisect_right(self.times, self.day) if direction > 0 else behind
        return self.paused().at(self.times[min(max(scan, 0), len(self.times) - 1)])

    def faster(self, steps: int = 1) -> Self:
        """By steps of SPEEDS, negative for slower."""
        index = SPEEDS.index(self.speed) + steps
        return replace(self, speed=SPEEDS[min(max(index, 0), len(SPEEDS) - 1)])
