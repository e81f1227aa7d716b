"""Coarse alignment: the way up, and all scans in one frame (section 3.1)."""

from baker.alignment.register import Alignment, align

__all__ = ["Alignment", "align"]
