"""The clock of the player: where in the series it stands and how it goes on. No graphics."""

from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Self

SPEEDS = (0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
SECONDS_PER_INTERVAL = 2.0  # at speed 1, on average over the series
SHORTEST, LONGEST = 4.0, 24.0  # seconds that a whole series takes at speed 1
REST = 0.8  # seconds to look at an end before the clock goes on
FRAMES = 30  # a second, of the steps from frame to frame


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
    rest: float = field(default=0.0, compare=False)  #: seconds that the clock still waits at an end
    #: of the part that is played; None for the series' own, as for `end`
    begin: float | None = None
    end: float | None = None

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
    def lower(self) -> float:
        """Where playing begins."""
        return self.first if self.begin is None else self.begin

    @property
    def upper(self) -> float:
        """Where playing ends."""
        return self.last if self.end is None else self.end

    @property
    def days_per_second(self) -> float:
        """How fast the clock goes, in the clip's unit of time."""
        seconds = min(max(SECONDS_PER_INTERVAL * (len(self.times) - 1), SHORTEST), LONGEST)
        return self.speed * (self.last - self.first) / seconds

    @property
    def _returns(self) -> bool:
        return self.backwards and self.at_end is AtEnd.PING_PONG

    def tick(self, seconds: float) -> Self:
        """Let wall time pass: however it is cut into frames, the clock arrives at the same day."""
        clock = self
        while clock.playing and seconds > 0.0:
            clock, seconds = clock._to_next_turn(seconds)
        return clock

    def _to_next_turn(self, seconds: float) -> tuple[Self, float]:
        """Rest, or go on to the end at most; returns the clock and the seconds left over."""
        if self.rest > 0.0:
            if seconds < self.rest:
                return replace(self, rest=self.rest - seconds), 0.0
            return self._turned(), seconds - self.rest
        if not self.lower <= self.day <= self.upper:
            return replace(self, day=self.upper if self._returns else self.lower), seconds
        goal, sign = (self.lower, -1.0) if self._returns else (self.upper, 1.0)
        needed = abs(goal - self.day) / self.days_per_second
        if seconds < needed:
            day = self.day + sign * seconds * self.days_per_second
            return replace(self, day=min(max(day, self.lower), self.upper)), 0.0
        if self.at_end is AtEnd.STOP:
            return replace(self, day=goal, playing=False, backwards=False), 0.0
        return replace(self, day=goal, rest=REST), seconds - needed

    def _turned(self) -> Self:
        if self.at_end is AtEnd.PING_PONG:
            return replace(self, rest=0.0, backwards=self.day == self.upper)
        return replace(self, rest=0.0, day=self.lower, backwards=False)

    def played(self) -> Self:
        """Start the clock; at the end of the series it starts over, or goes back."""
        at_goal = self.day == (self.lower if self._returns else self.upper)
        return replace(self._turned() if at_goal else self, playing=True)

    def paused(self) -> Self:
        return replace(self, playing=False, rest=0.0)

    def toggled(self) -> Self:
        return self.paused() if self.playing else self.played()

    def at(self, day: float) -> Self:
        """Go to a day; days outside the series give its first or last one."""
        return replace(self, day=min(max(day, self.first), self.last), rest=0.0)

    def nudged(self, share: float) -> Self:
        """Pause and go on by a share of the whole series, negative for back."""
        return self.paused().at(self.day + share * (self.last - self.first))

    def framed(self, count: int) -> Self:
        """Pause and go on by frames of a film, negative for back."""
        return self.paused().at(self.day + count * self.days_per_second / FRAMES)

    def begun_here(self) -> Self:
        """Play from this day on; an end that lies before it no longer counts."""
        begin = None if self.day in (self.first, self.last) else self.day
        return replace(self, begin=begin, end=self.end if self.upper > self.day else None)

    def ended_here(self) -> Self:
        """Play up to this day; a beginning that lies after it no longer counts."""
        end = None if self.day in (self.first, self.last) else self.day
        return replace(self, end=end, begin=self.begin if self.lower < self.day else None)

    def unbounded(self) -> Self:
        """Play the whole series."""
        return replace(self, begin=None, end=None)

    def stepped(self, direction: int) -> Self:
        """Pause at the next scan (direction 1) or the one before (-1)."""
        if direction > 0:
            ahead = [time for time in self.times if time > self.day]
            return self.paused().at(ahead[0] if ahead else self.last)
        behind = [time for time in self.times if time < self.day]
        return self.paused().at(behind[-1] if behind else self.first)

    def faster(self) -> Self:
        return replace(self, speed=min((s for s in SPEEDS if s > self.speed), default=SPEEDS[-1]))

    def slower(self) -> Self:
        return replace(self, speed=max((s for s in SPEEDS if s < self.speed), default=SPEEDS[0]))
