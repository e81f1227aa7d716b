"""The roll of an organ about its spine, between two scans.

A blade that rolls about its midrib by a right angle looks the same for either direction, so the
direction of the cross-sections in the next scan is not enough to tell one margin from the other.
The roll is continuous along the spine.
"""

from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import best_path
from baker.geometry.rigid import rotations_between
from baker.interpolation.spine import Floats, Points, section_weights

# docs/method.md, "Motion of organs".
ANGLES = 144  # number of angles among which the roll is searched for
# Scores that a radian costs: of the roll, and of its change from node to node.
ROLL_COST, TWIST_COST = 0.1, 0.3


def spine_frames(tangents: Points, target_tangents: Points) -> tuple[Points, Points]:
    """(NODES, 3, 3) frames along two spines, whose last columns are the (NODES, 3) tangents.

    They are carried along each spine by the smallest rotations from node to node; the first ones
    differ by the smallest rotation.
    """
    first = rotations_between(np.array([[0.0, 0.0, 1.0]]), tangents[:1])[0]
    frames = []
    for before, after in ((tangents, tangents), (tangents, target_tangents)):
        first = rotations_between(before[:1], after[:1])[0] @ first
        turns = rotations_between(after[:-1], after[1:])
        frames.append([*accumulate(turns, lambda frame, turn: turn @ frame, initial=first)])
    return np.array(frames[0]), np.array(frames[1])


def elongations(
    frames: Points, levels: Floats, offsets: Points, along: Floats
) -> NDArray[np.complex128]:
    """(NODES,) direction in which each cross-section is longest, and by how much.

    It is a complex number with twice the angle of the direction in the frame, and an absolute value
    from 0 for a disk to 1 for a line.

    levels: (NODES,) positions of the cross-sections along the spine. offsets, along: (n, 3) and
    (n,), of the organ's points from the spine, and their positions along it.
    """
    weights = section_weights(along, levels)
    places = np.einsum("ni,kij->knj", offsets, frames[:, :, :2]) @ (1.0, 1.0j)
    places -= (weights * places).sum(axis=1, keepdims=True)
    size = (weights * np.abs(places) ** 2).sum(axis=1)
    return np.asarray((weights * places**2).sum(axis=1) / np.maximum(size, 1e-300))


def roll(before: NDArray[np.complex128], after: NDArray[np.complex128]) -> Points:
    """(NODES, 3, 3) rotations about the spine by which the elongations agree best.

    Elongations that differ by half of a turn are the same, so the angles are as small, and as even
    along the spine, as their agreement allows.
    """
    from scipy.spatial.transform import Rotation

    angles = np.linspace(-np.pi, np.pi, ANGLES + 1)
    agreement = ((before.conj() * after)[:, None] * np.exp(-2j * angles)).real
    scores = agreement - ROLL_COST * angles**2
    changes = TWIST_COST * (angles[:, None] - angles) ** 2
    path = best_path([scores[:1], *(score - changes for score in scores[1:])])[1:]
    return np.asarray(Rotation.from_euler("z", angles[path, None]).as_matrix())
