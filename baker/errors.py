"""The baker's one error for bad input."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from gclip.errors import UserError
from gclip.text import printable


class InputError(UserError):
    """Scans or options that can't be baked; the message names the file and the remedy."""


def excerpt(text: str) -> str:
    """What a file says, short enough to be quoted."""
    return printable(text, 60)


@contextmanager
def asking(path: Path) -> Iterator[None]:
    """Ask the file system about `path`, or read it: what goes wrong is an InputError."""
    try:
        yield
    except UserError as error:
        raise InputError(str(error)) from error
    except OSError as error:
        what = printable(str(error.filename or path), 200)
        raise InputError(f"'{what}' can't be read: {error.strerror or error}.") from error
