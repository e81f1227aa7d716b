"""GPU time of each pass, by timer queries."""

from collections import Counter, defaultdict
from collections.abc import Iterator
from contextlib import contextmanager

import moderngl


class PassTimers:
    """Measures the passes of one renderer, frame by frame.

    frames: number of measured frames.
    totals: seconds of each pass, summed over these frames, in the order of the first one.
    """

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._idle: list[moderngl.Query] = []
        self._running: list[tuple[str, moderngl.Query]] = []
        self.frames = 0
        self.totals: defaultdict[str, float] = defaultdict(float)

    @contextmanager
    def timed(self, name: str) -> Iterator[None]:
        """Measure one pass; passes must not be nested."""
        query = self._idle.pop() if self._idle else self._context.query(time=True)
        with query:
            yield
        self._running.append((name, query))

    def finish_frame(self) -> float:
        """Seconds of the passes since the last call. Waits for passes that are still running, so it
        is best called one frame later.
        """
        seconds = 0.0
        for name, query in self._running:
            elapsed = 1e-9 * query.elapsed
            self.totals[name] += elapsed
            seconds += elapsed
            self._idle.append(query)
        self.frames += bool(self._running)
        self._running.clear()
        return seconds


def profile_table(timers: list[PassTimers]) -> str:
    """A table of the mean milliseconds per frame of each pass."""
    frames, totals = sum(one.frames for one in timers), Counter[str]()
    for one in timers:
        totals.update(one.totals)
    rows = [(name, 1e3 * seconds / max(frames, 1)) for name, seconds in totals.items()]
    rows.append((f"all of a frame ({frames} timed)", sum(each for _, each in rows)))
    width = max(len(name) for name, _ in rows)
    return "\n".join(f"{name:{width}}{each:9.3f} ms" for name, each in rows)
