"""How far work is, on stderr: bars on a terminal, plain lines in a pipe, nothing when quiet."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any, Self

from gclip.text import Lossy, printable

if TYPE_CHECKING:
    from rich.progress import ProgressColumn


class ProgressBars:
    """What reports progress derives from this; its bars are shown while it is a context.

    Standard output and error stay as they are: a worker process forked meanwhile never meets a lock
    of rich's console. That nobody reads the progress, or its log is full, does not end the work.
    """

    def __init__(self, quiet: bool, *columns: str | ProgressColumn) -> None:
        from rich.console import Console
        from rich.progress import Progress

        stderr: Any = Lossy(sys.stderr)
        self._console = Console(file=stderr, quiet=quiet, soft_wrap=True)
        bars = self._console.is_terminal and not quiet
        self.plain = not quiet and not bars  #: whether lines take the bars' place
        apart: Any = {"redirect_stdout": False, "redirect_stderr": False}
        self.bars = Progress(*columns, console=self._console, disable=not bars, **apart)

    def __enter__(self) -> Self:
        self.bars.start()
        return self

    def __exit__(self, *exception: Any) -> None:
        self.bars.stop()

    def say(self, sentence: str) -> None:
        """Print a line that stays, above the bars."""
        self._console.print(printable(sentence), markup=False, highlight=False)
