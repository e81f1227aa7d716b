"""GPU time of render passes, measured by OpenGL's timer queries."""

from collections import Counter, defaultdict
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext

import moderngl


class PassTimers:
    """Measures the frames of one renderer, or all passes of each frame.

    by_pass: whether to measure passes one by one, which keeps a GPU from running them side by side.
    frames:  number of measured frames.
    totals:  seconds of each pass by its name, summed over the frames.
    """

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._idle: list[moderngl.Query] = []
        self._running: list[tuple[str, moderngl.Query]] = []
        self.by_pass, self.frames = False, 0
        self.totals: defaultdict[str, float] = defaultdict(float)

    def frame(self) -> AbstractContextManager[None]:
        """Measure a frame, unless its passes are measured."""
        return nullcontext() if self.by_pass else self._timed("frame")

    def timed(self, name: str) -> AbstractContextManager[None]:
        """Measure one pass, if passes are measured."""
        return self._timed(name) if self.by_pass else nullcontext()

    @contextmanager
    def _timed(self, name: str) -> Iterator[None]:
        """Run a timer query; OpenGL does not allow nested ones."""
        query = self._idle.pop() if self._idle else self._context.query(time=True)
        with query:
            yield
        self._running.append((name, query))

    def finish_frame(self) -> float:
        """Return the GPU seconds since the last call.

        The call waits for passes that still run; it should therefore be made a frame later.
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
    """Format the mean milliseconds of each pass per frame as a table, summed over renderers."""
    frames, totals = sum(timer.frames for timer in timers), Counter[str]()
    for timer in timers:
        totals.update(timer.totals)
    rows = [(name, 1e3 * seconds / max(frames, 1)) for name, seconds in totals.items()]
    rows.append((f"all of a frame ({frames} timed)", sum(milliseconds for _, milliseconds in rows)))
    width = max(len(name) for name, _ in rows)
    return "\n".join(f"{name:{width}}{milliseconds:9.3f} ms" for name, milliseconds in rows)
