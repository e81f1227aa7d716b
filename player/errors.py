"""The player's one error for what the user can put right."""

from gclip.errors import UserError


class PlayerError(UserError):
    """A wish that can't be met: no screen, no EGL, a wrong size, an output refused."""
