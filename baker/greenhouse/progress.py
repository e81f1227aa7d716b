"""How many plants are done, while they are: a bar on a terminal, a line a plant in a pipe."""

from __future__ import annotations

from types import TracebackType
from typing import Self

from baker.greenhouse.work import Outcome
from gclip.text import printable


class PlantProgress:
    """Tells of each plant on stderr as soon as it is done; nothing when quiet."""

    def __init__(self, plants: int, quiet: bool, verbose: bool) -> None:
        """verbose: tell what was decided and found, too."""
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            Progress,
            TextColumn,
            TimeElapsedColumn,
            TimeRemainingColumn,
        )

        self._plants = plants
        self._verbose = verbose and not quiet
        self._console = Console(stderr=True, quiet=quiet, soft_wrap=True)
        self._lines = not quiet and not self._console.is_terminal
        self._bar = Progress(
            TextColumn("plants"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TextColumn("{task.fields[told]}", markup=False),
            TimeRemainingColumn(),
            console=self._console,
            disable=quiet or not self._console.is_terminal,
        )
        self._failed = self._done = 0
        self._task = self._bar.add_task("", total=plants, told="")

    def __enter__(self) -> Self:
        self._bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._bar.stop()

    def __call__(self, outcome: Outcome) -> None:
        self._failed += outcome.state == "failed"
        name = printable(outcome.name)
        told = f"{name} {outcome.state}" + (f", {self._failed} failed" * bool(self._failed))
        self._bar.update(self._task, advance=1, told=told)
        if self._lines:
            self._done += 1
            told = f"{name} {outcome.state}, {outcome.seconds:.1f} s"
            self.say(f"{self._done}/{self._plants}: {told}")
        if self._verbose:
            for note in outcome.notes:
                self.say(f"    {note}")

    def say(self, sentence: str) -> None:
        """Something else that is to be told meanwhile."""
        self._console.print(printable(sentence), markup=False, highlight=False)
