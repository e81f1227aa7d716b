"""What holds for all tests."""

from __future__ import annotations

from hypothesis import settings

# How long a case takes never decides whether a test passes.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")
