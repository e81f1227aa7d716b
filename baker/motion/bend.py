"""Carry an organ from the spine it had onto the spine it has."""

from __future__ import annotations

import numpy as np

from baker.motion import rotation
from baker.motion.spine import Points, Spine, at_levels, levels

ROLLS = np.radians(np.arange(-90, 91, 30))  # of the base
TWISTS = np.radians(np.arange(-60, 61, 30))  # of the tip beyond the base
ROLL_PRICE = 0.05  # by how much a roll of 90 degrees must bring the clouds nearer
SEARCHED = 300  # points of either side that decide


def bend(start: Points, end: Points, here: Spine, there: Spine) -> Points:
    """(n, 3) the start's points laid along the end's spine, at their place along.

    Each level turns by the smallest rotation of its tangent and by one roll about it, for the
    whole organ: the smallest of those that bring the clouds nearest to each other.
    """
    from scipy.spatial import cKDTree

    turns = rotation.between(here.tangents, there.tangents)
    offset = start - at_levels(here.nodes, here.along)
    other = end - at_levels(there.nodes, there.along)
    width = np.sqrt((other**2).sum(1).mean() / max((offset**2).sum(1).mean(), 1e-30))
    width = float(np.clip(width, 1 / 3, 3))

    def laid(roll: float, twist: float, chosen: slice = slice(None)) -> Points:
        along = here.along[chosen]
        rolled = rotation.about(there.tangents, roll + twist * levels()) @ turns
        turned = np.einsum("nij,nj->ni", at_levels(rolled, along), offset[chosen])
        return at_levels(there.nodes, along) + width * turned

    some = slice(None, None, max(len(start) // SEARCHED, 1))
    sparse = end[:: max(len(end) // SEARCHED, 1)]
    tree = cKDTree(end)

    def price(choice: tuple[float, float]) -> float:
        points = laid(*choice, some)
        far = tree.query(points)[0].mean() + cKDTree(points).query(sparse)[0].mean()
        turned = abs(choice[0]) + abs(choice[0] + choice[1])
        return float(far * (1.0 + ROLL_PRICE * turned / np.pi))

    return laid(*min(((roll, twist) for roll in ROLLS for twist in TWISTS), key=price))
