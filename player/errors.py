"""The exception for errors that the user can correct."""

from gclip.errors import UserError


class PlayerError(UserError):
    """Raised for problems that the user can correct, such as a missing display or a wrong size."""
