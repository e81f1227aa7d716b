"""How a bake reports its progress."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from gclip.terminal.progress import ProgressBars
from gclip.terminal.text import printable

if TYPE_CHECKING:
    from baker.batch.job import Outcome


class StageProgress(ProgressBars):
    """The `progress` callable of `bake`: shows its stages one after the other.

    `seconds` maps finished stages to durations.
    """

    def __init__(self, quiet: bool = False) -> None:
        from rich.progress import BarColumn, MofNCompleteColumn, TaskID

        super().__init__(
            quiet,
            "{task.description:<14}",
            BarColumn(),
            MofNCompleteColumn(),
            "{task.fields[seconds]:5.1f} s",
        )
        self.seconds: dict[str, float] = {}
        self._stage: str | None = None
        self._task: TaskID | None = None
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
        assert self._task is not None
        self.bars.update(self._task, completed=done, total=total, seconds=elapsed)

    def _finish(self) -> None:
        if self._stage is not None:
            elapsed = time.perf_counter() - self._began
            self.seconds[self._stage] = self.seconds.get(self._stage, 0.0) + elapsed
            if self.plain:
                self.say(f"{self._stage}: {elapsed:.1f} s")
        self._stage = None
        self._began = time.perf_counter()


class PlantProgress(ProgressBars):
    """Shows how many of the plants are done; in a pipe a line a plant."""

    def __init__(self, plants: int, quiet: bool, verbose: bool) -> None:
        from rich import progress

        super().__init__(
            quiet,
            "plants",
            progress.BarColumn(),
            progress.MofNCompleteColumn(),
            progress.TimeElapsedColumn(),
            progress.TextColumn("{task.fields[latest]}", markup=False),
            progress.TimeRemainingColumn(),
        )
        self._plants = plants
        self._verbose = verbose and not quiet
        self._failed = self._done = 0
        self._task = self.bars.add_task("", total=plants, latest="")

    def __call__(self, outcome: Outcome) -> None:
        self._failed += outcome.state == "failed"
        self._done += 1
        name = printable(outcome.name)
        failed = f", {self._failed} failed" * bool(self._failed)
        self.bars.update(self._task, advance=1, latest=f"{name} {outcome.state}{failed}")
        if self.plain:
            sentence = f"{name} {outcome.state}, {outcome.seconds:.1f} s"
            self.say(f"{self._done}/{self._plants}: {sentence}")
        if self._verbose:
            for note in outcome.notes:
                self.say(f"    {note}")
