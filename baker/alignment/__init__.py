"""Coarse alignment: the way up, and every scan brought onto its predecessor (section 3.1)."""

from baker.alignment.register import Alignment, PairFit, align
from baker.alignment.up_axis_search import find_up

__all__ = ["Alignment", "PairFit", "align", "find_up"]
