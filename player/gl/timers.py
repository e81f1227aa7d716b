"""GPU time of render passes, measured by OpenGL's timer queries."""

from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager

import moderngl


class PassTimers:
    """Measures the passes of a context's renderers, frame by frame, which takes time itself.

    frames: number of measured frames.
    totals: seconds of each pass by its name, summed over the frames.
    """

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._idle = list[moderngl.Query]()
        self._running, self._before = (list[tuple[str, moderngl.Query]]() for _ in range(2))
        self.frames = 0
        self.totals: defaultdict[str, float] = defaultdict(float)

    @contextmanager
    def timed(self, name: str) -> Iterator[None]:
        """Measure one pass; OpenGL does not allow nested timer queries."""
        query = self._idle.pop() if self._idle else self._context.query(time=True)
        with query:
            yield
        self._running.append((name, query))

    def finish_frame(self) -> float:
        """Return the GPU seconds of all passes between the two calls before this one.

        Passes since the last call may still run, and a GPU is idle while one waits for it.
        """
        seconds = 0.0
        for name, query in self._before:
            elapsed = 1e-9 * query.elapsed
            self.totals[name] += elapsed
            seconds += elapsed
            self._idle.append(query)
        self.frames += bool(self._before)
        self._before, self._running = self._running, []
        return seconds


def profile_table(timers: PassTimers) -> str:
    """Format the mean milliseconds of each pass per frame as a table."""
    frames = timers.frames
    rows = [(name, 1e3 * seconds / max(frames, 1)) for name, seconds in timers.totals.items()]
    rows.append((f"all of a frame ({frames} timed)", sum(milliseconds for _, milliseconds in rows)))
    width = max(len(name) for name, _ in rows)
    return "\n".join(f"{name:{width}}{milliseconds:9.3f} ms" for name, milliseconds in rows)
