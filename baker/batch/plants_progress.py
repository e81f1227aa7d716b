"""How many plants are done, while they are: in a pipe a line a plant."""

from __future__ import annotations

from baker.batch.work import Outcome
from gclip.terminal.progress import ProgressBars
from gclip.terminal.text import printable


class PlantProgress(ProgressBars):
    """Tells of each plant as soon as it is done."""

    def __init__(self, plants: int, quiet: bool, verbose: bool) -> None:
        """verbose: tell what was decided and found, too."""
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            TextColumn,
            TimeElapsedColumn,
            TimeRemainingColumn,
        )

        super().__init__(
            quiet,
            "plants",
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TextColumn("{task.fields[told]}", markup=False),
            TimeRemainingColumn(),
        )
        self._plants = plants
        self._verbose = verbose and not quiet
        self._failed = self._done = 0
        self._task = self.bars.add_task("", total=plants, told="")

    def __call__(self, outcome: Outcome) -> None:
        self._failed += outcome.state == "failed"
        name = printable(outcome.name)
        told = f"{name} {outcome.state}" + (f", {self._failed} failed" * bool(self._failed))
        self.bars.update(self._task, advance=1, told=told)
        if self.plain:
            self._done += 1
            told = f"{name} {outcome.state}, {outcome.seconds:.1f} s"
            self.say(f"{self._done}/{self._plants}: {told}")
        if self._verbose:
            for note in outcome.notes:
                self.say(f"    {note}")
