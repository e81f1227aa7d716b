"""Coarse alignment of the scans of a series: the up axis and a common frame (section 3.1)."""

from baker.alignment.register import Alignment, align

__all__ = ["Alignment", "align"]
