"""How an export tells where it is: a bar on a terminal, plain lines in a pipe, else nothing."""

from __future__ import annotations

from types import TracebackType
from typing import Self


class FrameProgress:
    """An instance is the `progress` callable of `export`: steps done, steps in all."""

    def __init__(self, quiet: bool = False, doing: str = "drawing") -> None:
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            Progress,
            TextColumn,
            TimeRemainingColumn,
        )

        self._console = Console(stderr=True, quiet=quiet)
        self._plain = not quiet and not self._console.is_terminal
        self._bar = Progress(
            TextColumn(doing),
            BarColumn(),
            MofNCompleteColumn(),
            TimeRemainingColumn(),
            console=self._console,
            disable=quiet or not self._console.is_terminal,
        )
        self._task = self._bar.add_task(doing, total=None)
        self._doing = doing
        self._tenth = 0

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

    def __call__(self, done: int, total: int) -> None:
        self._bar.update(self._task, completed=done, total=total)
        if self._plain and 10 * done // total > self._tenth:
            self._tenth = 10 * done // total
            self._console.print(f"{self._doing}: {done} of {total}", highlight=False)
