"""How long each pass over points or picture takes on the GPU, by timer queries."""

from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager

import moderngl


class PassTimers:
    """Times the passes of one renderer, frame by frame.

    Attributes
    ----------
    frames : int
        How many were timed.
    totals : dict of str
        Seconds that each pass took in all of them together, in the order of the first frame's.
    """

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._idle: list[moderngl.Query] = []
        self._running: list[tuple[str, moderngl.Query]] = []
        self.frames = 0
        self.totals: defaultdict[str, float] = defaultdict(float)

    @contextmanager
    def timed(self, name: str) -> Iterator[None]:
        """Around one pass; passes don't hold each other."""
        query = self._idle.pop() if self._idle else self._context.query(time=True)
        with query:
            yield
        self._running.append((name, query))

    def finish_frame(self) -> float:
        """Seconds that the passes since the last call took. Waits for them: call it when they have
        had the time of a frame.
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

    def reset(self) -> None:
        """Forget all that was timed so far."""
        self.finish_frame()
        self.frames = 0
        self.totals.clear()


def profile_table(timers: list[PassTimers]) -> str:
    """Milliseconds of a frame, pass by pass, the mean of all that were timed."""
    frames = sum(one.frames for one in timers)
    names = dict.fromkeys(name for one in timers for name in one.totals)
    totals = [(name, sum(one.totals[name] for one in timers)) for name in names]
    rows = [(name, 1e3 * seconds / max(frames, 1)) for name, seconds in totals]
    rows.append((f"all of a frame ({frames} timed)", sum(each for _, each in rows)))
    width = max(len(name) for name, _ in rows)
    return "\n".join(f"{name:{width}}{each:9.3f} ms" for name, each in rows)
