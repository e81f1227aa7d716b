"""The baker's one error for bad input."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from gclip.errors import UserError
from gclip.terminal.text import printable

LONGEST = 1000  # characters of a sentence


class InputError(UserError):
    """Scans or options that can't be baked; the message names the file and the remedy.

    What files hold may stand in it: nothing that a terminal would obey gets through.
    """

    def __init__(self, sentence: str) -> None:
        super().__init__(printable(sentence, LONGEST))


def excerpt(text: str) -> str:
    """What a file says, short enough to be quoted."""
    return printable(text, 60)


@contextmanager
def asking(path: Path) -> Iterator[None]:
    """Ask the file system about `path`: what it refuses to tell is an InputError."""
    try:
        yield
    except OSError as error:
        what = printable(str(error.filename or path), 200)
        raise InputError(f"'{what}' can't be read: {error.strerror or error}.") from error
