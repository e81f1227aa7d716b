"""Show the progress of a bake in the terminal, stage by stage or plant by plant."""

import time
from typing import Any

from gclip.terminal.progress import ProgressBars


class StageProgress(ProgressBars):
    """The `progress` callable of `bake`, which shows the stages one after the other.

    seconds: stage -> duration, of the stages that are finished.
    """

    def __init__(self, quiet: bool = False) -> None:
        from rich.progress import BarColumn, MofNCompleteColumn, TaskID, TimeRemainingColumn

        super().__init__(
            quiet,
            "{task.description:<14}",
            BarColumn(),
            MofNCompleteColumn(),
            "{task.fields[seconds]:5.1f} s",
            TimeRemainingColumn(),
        )
        self.seconds: dict[str, float] = {}
        self._stage: str | None = None
        self._task = TaskID(0)
        self._began = time.perf_counter()

    def __exit__(self, *exception: Any) -> None:
        if exception[0] is None:
            self._finish()
        super().__exit__(*exception)

    def __call__(self, stage: str, done: int, total: int) -> None:
        if stage != self._stage:
            self._finish()
            self._stage = stage
            self._task = self.bars.add_task(stage, total=total, seconds=0.0)
        elapsed = time.perf_counter() - self._began
        self.bars.update(self._task, completed=done, total=total, seconds=elapsed)

    def _finish(self) -> None:
        now = time.perf_counter()
        if self._stage is not None:
            elapsed = now - self._began
            self.seconds[self._stage] = self.seconds.get(self._stage, 0.0) + elapsed
            if self.plain:
                self.say(f"{self._stage}: {elapsed:.1f} s")
        self._stage, self._began = None, now
