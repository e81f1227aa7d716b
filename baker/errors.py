"""The exception that the baker raises for bad input."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from gclip.errors import UserError
from gclip.text import printable


class InputError(UserError):
    """Scans or options can't be baked; the message is one sentence that says what to change."""


def excerpt(text: str) -> str:
    """Make a text printable and at most 60 characters long, so that a message can quote it."""
    return printable(text, 60)


@contextmanager
def input_errors(path: Path) -> Iterator[None]:
    """Raise errors of the file system while `path` is read as an InputError that names it."""
    try:
        yield
    except UserError as error:
        raise InputError(str(error)) from error
    except OSError as error:
        name = printable(str(error.filename or path), 200)
        raise InputError(f"'{name}' can't be read: {error.strerror or error}.") from error
