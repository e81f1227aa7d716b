"""Carry an organ from the spine it had onto the spine it has."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.geometry import rotation
from baker.interpolation.spine import Points, Spine, at_levels, levels

ROLLS = np.radians(np.arange(-90, 91, 30))  # of the base
TWISTS = np.radians(np.arange(-60, 61, 30))  # of the tip beyond the base
ROLL_PRICE = 0.05  # by how much a roll of 90 degrees must bring the clouds nearer
SEARCHED = 100  # points of either side that decide


def bend(start: Points, end: Points, here: Spine, there: Spine) -> Points:
    """(n, 3) the start's points laid along the end's spine, at their place along.

    Each level turns by the smallest rotation of its tangent and by one roll about it, for the
    whole organ: the smallest of those that bring the clouds nearest to each other.
    """
    from baker.interpolation.drawing import laid
    from baker.interpolation.nearest import nearest_cloud

    turns = rotation.between(here.tangents, there.tangents)
    offset = start - at_levels(here.nodes, here.along)
    other = end - at_levels(there.nodes, there.along)
    width = np.sqrt((other**2).sum(1).mean() / max((offset**2).sum(1).mean(), 1e-30))
    width = float(np.clip(width, 1 / 3, 3))

    def lay(rolls: NDArray[np.float64], chosen: slice = slice(None)) -> NDArray[np.float64]:
        """(c, n, 3) the chosen points, each level rolled by (c, LEVELS) angles."""
        axes = np.tile(there.tangents, (len(rolls), 1))
        rolled = rotation.about(axes, rolls.ravel()).reshape(*rolls.shape, 3, 3) @ turns
        along, off = (np.ascontiguousarray(values[chosen]) for values in (here.along, offset))
        return laid(there.nodes, rolled, along, off, width)

    choices = np.array([(roll, twist) for roll in ROLLS for twist in TWISTS])
    rolls = choices[:, :1] + choices[:, 1:] * levels()
    some = slice(None, None, max(len(start) // SEARCHED, 1))
    sparse = np.ascontiguousarray(end[:: max(len(end) // SEARCHED, 1)])
    turned = np.abs(choices[:, 0]) + np.abs(choices.sum(axis=1))
    best = nearest_cloud(lay(rolls, some), end, sparse, 1.0 + ROLL_PRICE * turned / np.pi)
    return lay(rolls[[best]])[0]
