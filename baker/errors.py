"""The baker's one error for bad input."""

from gclip.errors import UserError


class InputError(UserError):
    """Scans or options that can't be baked; the message names the file and the remedy."""
