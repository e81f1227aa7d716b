"""How a bake tells where it is: bars on a terminal, plain lines in a pipe, nothing when quiet."""

from __future__ import annotations

import time
from types import TracebackType
from typing import Self


class StageProgress:
    """Shows the stages of a bake one after the other on stderr and keeps their durations.

    An instance is the `progress` callable of `bake`; `seconds` maps finished stages to durations.
    """

    def __init__(self, quiet: bool = False) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn

        self.seconds: dict[str, float] = {}
        self._console = Console(stderr=True, quiet=quiet)
        self._bars = Progress(
            TextColumn("{task.description:<14}"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[seconds]:5.1f} s"),
            console=self._console,
            disable=quiet or not self._console.is_terminal,
            refresh_per_second=8,
        )
        self._plain = not quiet and not self._console.is_terminal
        self._stage: str | None = None
        self._task: TaskID | None = None
        self._began = time.perf_counter()

    def __enter__(self) -> Self:
        self._bars.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if kind is None:
            self._finish()
        self._bars.stop()

    def __call__(self, stage: str, done: int, total: int) -> None:
        if stage != self._stage:
            self._finish()
            self._stage = stage
            self._task = self._bars.add_task(stage, total=total, seconds=0.0)
        elapsed = time.perf_counter() - self._began
        assert self._task is not None
        self._bars.update(self._task, completed=done, total=total, seconds=elapsed)

    def _finish(self) -> None:
        if self._stage is not None:
            elapsed = time.perf_counter() - self._began
            self.seconds[self._stage] = self.seconds.get(self._stage, 0.0) + elapsed
            if self._plain:
                self._console.print(f"{self._stage}: {elapsed:.1f} s", highlight=False)
        self._stage = None
        self._began = time.perf_counter()
