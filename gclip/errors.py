"""Errors whose message is one clear sentence for the person who typed the command."""

from gclip.text import printable

LONGEST = 1000  # characters of a sentence


class UserError(Exception):
    """Something the user can put right; the message is one sentence, shown as it is.

    What files hold may stand in it: nothing that a terminal would obey gets through.
    """

    def __init__(self, sentence: str) -> None:
        super().__init__(printable(sentence, LONGEST))


class ClipError(UserError):
    """A growth clip that can't be read, is damaged, or contradicts itself."""
