"""Rotations of the cross-sections of an organ between two scans, about its spine.

A blade that rolls about its midrib by a right angle looks the same for either direction, so the
direction of the cross-sections in the next scan is not enough to tell one margin from the other.
The roll is continuous along the spine.
"""

from dataclasses import dataclass
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


@dataclass(frozen=True)
class Sections:
    """The cross-sections of an organ at the nodes of its spine, in one scan."""

    tangents: Points  # (NODES, 3) of the spine at the nodes
    levels: Floats  # (NODES,) positions of the nodes along the spine
    offsets: Points  # (n, 3) of the organ's points from the spine
    along: Floats  # (n,) positions of the points along the spine

    def elongations(self, frames: Points) -> NDArray[np.complex128]:
        """(NODES,) direction in which each section is longest, and by how much.

        It is a complex number with twice the angle of the direction in the (NODES, 3, 3) frames,
        and an absolute value from 0 for a disk to 1 for a line.
        """
        weights = section_weights(self.along, self.levels)
        places = np.einsum("ni,kij->knj", self.offsets, frames[:, :, :2]) @ (1.0, 1.0j)
        places -= (weights * places).sum(axis=1, keepdims=True)
        size = (weights * np.abs(places) ** 2).sum(axis=1)
        return np.asarray((weights * places**2).sum(axis=1) / np.maximum(size, 1e-300))


def spine_rotations(source: Sections, target: Sections, has_roll: bool) -> Points:
    """(NODES, 3, 3) rotations of an organ's cross-sections from one scan to the next.

    Frames are carried along both spines by the smallest rotations from node to node, and the first
    ones differ by the smallest rotation.

    has_roll: whether the organ rolls about its spine. Then the target's frames are rotated by the
    roll.
    """
    from scipy.spatial.transform import Rotation

    z, base = np.array([[0.0, 0.0, 1.0]]), source.tangents[:1]
    first = rotations_between(z, base)[0]
    frames = _least_turning_frames(source.tangents, first)
    first = rotations_between(base, target.tangents[:1])[0] @ first
    target_frames = _least_turning_frames(target.tangents, first)
    if has_roll:
        elongations = source.elongations(frames), target.elongations(target_frames)
        about_z = np.multiply.outer(_roll(*elongations), (0.0, 0.0, 1.0))
        target_frames = target_frames @ Rotation.from_rotvec(about_z).as_matrix()
    return target_frames @ frames.transpose(0, 2, 1)


def _roll(before: NDArray[np.complex128], after: NDArray[np.complex128]) -> Floats:
    """(NODES,) angles, small and continuous along the spine, by which the elongations agree best.

    Elongations that differ by half of a turn are the same.
    """
    angles = np.linspace(-np.pi, np.pi, ANGLES + 1)
    agreement = ((before.conj() * after)[:, None] * np.exp(-2j * angles)).real
    scores = agreement - ROLL_COST * angles**2
    changes = TWIST_COST * (angles[:, None] - angles) ** 2
    return angles[best_path([scores[:1], *(score - changes for score in scores[1:])])[1:]]


def _least_turning_frames(tangents: Points, first: Points) -> Points:
    """(NODES, 3, 3) frames, the first one given, with the tangents in their last columns."""
    turns = rotations_between(tangents[:-1], tangents[1:])
    return np.array([*accumulate(turns, lambda frame, turn: turn @ frame, initial=first)])
