"""Exceptions whose message is one sentence for the user."""

from gclip.text import printable

LONGEST = 1000  # characters of a sentence


class UserError(Exception):
    """An error that the user can correct; the message is one sentence, which is printed.

    Control characters in the message, which may quote files, are replaced.
    """

    def __init__(self, sentence: str) -> None:
        super().__init__(printable(sentence, LONGEST))


class ClipError(UserError):
    """A growth clip that can't be read, is damaged, or contradicts itself."""
