"""Procedural plants with known truth: their shape, and where each point of it is, at any time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from grow.kinds import KINDS

if TYPE_CHECKING:
    from grow.model import Plant

__all__ = ["KINDS", "plant"]


def plant(kind: str, seed: int = 0) -> Plant:
    """Grow a plant from a seed; the same kind and seed give the same plant, at every time.

    kind: one of `KINDS`. tree1 and tree2 are the bare trees of the paper's Table 1 and Figure 11
    (four scans of 778 to 2,253 points; two scans of 77,448 and 326,032 points).
    Raises baker.errors.InputError for an unknown kind or a negative seed.
    """
    from grow.model import grow_plant

    return grow_plant(kind, seed)
