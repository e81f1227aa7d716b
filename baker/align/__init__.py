"""Coarse alignment: the way up, and every scan brought onto its predecessor (section 3.1)."""

from baker.align.register import Alignment, PairFit, align
from baker.align.up import find_up

__all__ = ["Alignment", "PairFit", "align", "find_up"]
