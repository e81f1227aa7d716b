"""Scans set upright on their stem's base, and how one is turned onto another."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.alignment.organs import Organs, find_organs
from baker.alignment.stem_base import base_candidates
from baker.alignment.up_axis_search import upright
from baker.geometry.sample_graph import AROUND, touching_pairs
from baker.geometry.sampling import EvenSample
from baker.geometry.up_axis import Vertical

# Of the lower plant's height: how much of both is compared, and how near what belongs together is.
FOOT, TOGETHER = 0.1, (0.03, 0.02)
FOUND = 0.1  # of a foot: with fewer of its points near the other's it is no help
STEPS = 4


@dataclass(frozen=True)
class Stand:
    """A scan set upright with its stem's base at the origin.

    frame:   (4, 4) from the scan's coordinates to these.
    sample:  in these.
    organs:  of the sample.
    """

    frame: NDArray[np.float64]
    sample: EvenSample
    organs: Organs

    @property
    def base(self) -> NDArray[np.float64]:
        """(3,) in the scan's own coordinates."""
        return np.asarray(np.linalg.inv(self.frame)[:3, 3])

    @property
    def height(self) -> float:
        return float(np.ptp(self.sample.points[:, 2]))


def possible_stands(
    sample: EvenSample, vertical: Vertical, root: NDArray[np.floating] | None = None
) -> list[Stand]:
    """The scan of which `sample` was taken, on each base it may have, or on its (3,) root."""
    pairs = touching_pairs(sample, AROUND)
    if root is not None:
        return [_stand_at(sample, vertical, np.asarray(root, float), pairs)]
    bases = base_candidates(sample, vertical, pairs)
    return [_stand_at(sample, vertical, base, pairs) for base in bases]


def move(earlier: Stand, later: Stand, yaw: float) -> NDArray[np.float64]:
    """(4, 4) from the later scan's coordinates to the earlier's: turned by `yaw`, foot on foot."""
    onto = about_z(yaw)
    onto[:2, 3] = _foot_shift(earlier, later, onto)
    return np.linalg.inv(earlier.frame) @ onto @ later.frame


def about_z(yaw: float) -> NDArray[np.float64]:
    """(4, 4) rotation by degrees about +z, right-handed."""
    from scipy.spatial.transform import Rotation

    turn = np.eye(4)
    turn[:3, :3] = Rotation.from_euler("z", yaw, degrees=True).as_matrix()
    return turn


def _foot_shift(earlier: Stand, later: Stand, onto: NDArray[np.float64]) -> NDArray[np.float64]:
    """(2,) how much further the later scan's foot has to be moved, level, to cover the earlier's.

    A base is the middle of a few points at the ground. The foot of the stem above it hardly
    changes: its points are moved onto their nearest ones, and those of leaves that hang there, far
    from any partner, don't pull.
    """
    from scipy.spatial import cKDTree

    height = min(earlier.height, later.height)
    foot, other = (stand.sample.pool for stand in (earlier, later))
    foot, other = foot[foot[:, 2] <= FOOT * height], other[other[:, 2] <= FOOT * height]
    shift = np.zeros(3)
    if height == 0.0 or not len(foot) or not len(other):
        return shift[:2]
    other = other @ onto[:3, :3].T
    tree = cKDTree(other)
    for together in TOGETHER:
        for _ in range(STEPS):
            gaps, nearest = tree.query(foot - shift)
            weights = np.exp(-0.5 * (gaps / (together * height)) ** 2)
            if weights.mean() < FOUND:
                return np.zeros(2)
            apart = foot - shift - other[nearest]
            shift[:2] += (weights[:, None] * apart[:, :2]).sum(axis=0) / weights.sum()
    return shift[:2]


def _stand_at(
    sample: EvenSample, vertical: Vertical, base: NDArray[np.float64], pairs: NDArray[np.intp]
) -> Stand:
    turn = upright(vertical)
    frame = np.eye(4)
    frame[:3, :3], frame[:3, 3] = turn, -turn @ base
    moved = EvenSample((sample.pool - base) @ turn.T, (sample.points - base) @ turn.T, sample.radii)
    return Stand(frame, moved, find_organs(moved, pairs))
