"""Show progress on stderr: bars in a terminal, lines in a pipe or log, nothing when quiet."""

import sys
import time
from typing import Any, Self

from gclip.text import Lossy, printable


class StageProgress:
    """Shows the stages of a command one after the other; call it with (stage, done, total).

    The bars are shown while the context is active. stdout and stderr are not redirected, since a
    process forked meanwhile could wait forever for a lock of rich's console. Errors in writing the
    progress are ignored.
    """

    def __init__(self, quiet: bool = False) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeRemainingColumn

        stderr: Any = Lossy(sys.stderr)
        self._console = Console(file=stderr, quiet=quiet, soft_wrap=True)
        self.plain = not (quiet or self._console.is_terminal)  #: lines instead of bars
        self.seconds: dict[str, float] = {}  #: stage -> duration, of the stages that are finished
        remaining = TimeRemainingColumn(elapsed_when_finished=True)
        columns = "{task.description:<14}", BarColumn(), MofNCompleteColumn(), remaining
        shown: dict[str, Any] = {"console": self._console, "disable": quiet or self.plain}
        self.bars = Progress(*columns, **shown, redirect_stdout=False, redirect_stderr=False)
        self._stage: str | None = None
        self._task: Any = None
        self._began = time.perf_counter()

    def __enter__(self) -> Self:
        self.bars.start()
        return self

    def __exit__(self, *exception: Any) -> None:
        if exception[0] is None:
            self._finish()
        self.bars.stop()

    def __call__(self, stage: str, done: int, total: int) -> None:
        if stage != self._stage:
            self._finish()
            self._stage, self._task = stage, self.bars.add_task(stage)
        self.bars.update(self._task, completed=done, total=total)

    def say(self, sentence: str) -> None:
        """Print a line above the bars."""
        self._console.print(printable(sentence), markup=False, highlight=False)

    def _finish(self) -> None:
        elapsed = time.perf_counter() - self._began
        if self._stage is not None:
            self.seconds[self._stage] = self.seconds.get(self._stage, 0.0) + elapsed
            if self.plain:
                self.say(f"{self._stage}: {elapsed:.1f} s")
        self._stage, self._began = None, time.perf_counter()
