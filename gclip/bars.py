"""How far work is, on stderr: bars on a terminal, plain lines in a pipe, nothing when quiet."""

from __future__ import annotations

from types import TracebackType
from typing import TYPE_CHECKING, Self

from gclip.text import printable

if TYPE_CHECKING:
    from rich.progress import ProgressColumn


class Bars:
    """What tells of work under way builds on this; the bars are there while it is a context.

    plain: whether lines take the bars' place.
    """

    def __init__(self, quiet: bool, *columns: str | ProgressColumn) -> None:
        from rich.console import Console
        from rich.progress import Progress

        self._console = Console(stderr=True, quiet=quiet, soft_wrap=True)
        terminal = self._console.is_terminal
        self.plain = not quiet and not terminal
        self.bars = Progress(*columns, console=self._console, disable=quiet or not terminal)

    def __enter__(self) -> Self:
        self.bars.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.bars.stop()

    def say(self, sentence: str) -> None:
        """A line that stays, above the bars."""
        self._console.print(printable(sentence), markup=False, highlight=False)
