"""Show progress on stderr: bars in a terminal, lines in a pipe or log, nothing when quiet."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any, Self

from gclip.text import Lossy, printable

if TYPE_CHECKING:
    from rich.progress import ProgressColumn


class ProgressBars:
    """Base class of progress reports; the bars are shown while the context is active.

    stdout and stderr are not redirected, since a process forked meanwhile could wait forever for a
    lock of rich's console. Errors in writing the progress are ignored.
    """

    def __init__(self, quiet: bool, *columns: str | ProgressColumn) -> None:
        from rich.console import Console
        from rich.progress import Progress

        stderr: Any = Lossy(sys.stderr)
        self._console = Console(file=stderr, quiet=quiet, soft_wrap=True)
        has_bars = self._console.is_terminal and not quiet
        self.plain = not quiet and not has_bars  #: whether lines are printed instead of bars
        redirect: Any = {"redirect_stdout": False, "redirect_stderr": False}
        self.bars = Progress(*columns, console=self._console, disable=not has_bars, **redirect)

    def __enter__(self) -> Self:
        self.bars.start()
        return self

    def __exit__(self, *exception: Any) -> None:
        self.bars.stop()

    def say(self, sentence: str) -> None:
        """Print a line above the bars."""
        self._console.print(printable(sentence), markup=False, highlight=False)
