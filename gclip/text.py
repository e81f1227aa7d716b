"""Text from files that anyone may have written, safe to print in any terminal and any log."""

import io
import os
import unicodedata
from typing import Any, TextIO

# Control characters, surrogates, separators of lines, and formats such as those that turn the
# direction of writing; joiners are formats too, and some scripts need them.
UNSAFE = {"Cc", "Cf", "Cs", "Zl", "Zp"}
JOINERS = "\N{ZERO WIDTH NON-JOINER}\N{ZERO WIDTH JOINER}"


def printable(text: str, most: int | None = None) -> str:
    """`text` on one line, at `most` so long, with U+FFFD for what a terminal obeys, not shows."""
    if most is not None and len(text) > most:
        text = text[: most - 1] + "…"
    if text.isprintable():
        return text
    safe = (c in JOINERS or unicodedata.category(c) not in UNSAFE for c in text)
    return "".join(c if s else "\N{REPLACEMENT CHARACTER}" for c, s in zip(text, safe, strict=True))


class Lossy:
    """A stream, or none where it is closed; what can't be written is lost, and ends no work."""

    def __init__(self, stream: TextIO | None) -> None:
        self._stream = stream or io.StringIO()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> None:
        try:
            self._stream.write(text)
            self._stream.flush()
        except OSError:  # nobody reads, or the disk is full: what Python still holds goes nowhere
            os.dup2(os.open(os.devnull, os.O_WRONLY), self._stream.fileno())
