"""Errors whose message is one clear sentence for the person who typed the command."""


class UserError(Exception):
    """Something the user can put right; the message is one sentence, shown as it is."""


class ClipError(UserError):
    """A growth clip that can't be read, is damaged, or contradicts itself."""
