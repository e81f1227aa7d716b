"""Make text from untrusted files safe to print in a terminal or a log."""

import io
import os
import unicodedata
from typing import Any, TextIO

# Unicode categories: control characters, format characters such as those for the direction of
# writing, surrogates, and line and paragraph separators. Some scripts need the joiners.
UNSAFE = {"Cc", "Cf", "Cs", "Zl", "Zp"}
JOINERS = "\N{ZERO WIDTH NON-JOINER}\N{ZERO WIDTH JOINER}"


def printable(text: str, most: int | None = None) -> str:
    """Replace unsafe characters by U+FFFD, and cut the text to `most` characters."""
    if most is not None and len(text) > most:
        text = text[: most - 1] + "…"
    if text.isprintable():
        return text
    return "".join(
        c if c in JOINERS or unicodedata.category(c) not in UNSAFE else "\N{REPLACEMENT CHARACTER}"
        for c in text
    )


class Lossy:
    """A stream, or None if it is closed, that discards what can't be written without an error."""

    def __init__(self, stream: TextIO | None) -> None:
        self._stream = stream or io.StringIO()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> None:
        try:
            self._stream.write(text)
            self._stream.flush()
        except OSError:  # the pipe is closed or the disk is full: discard the rest as well
            os.dup2(os.open(os.devnull, os.O_WRONLY), self._stream.fileno())
