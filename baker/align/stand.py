"""Scans set upright on their stem's base, and how one is turned onto another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from baker.align.base import stem_bases
from baker.align.icp import trimmed_residual
from baker.align.sample import EvenSample
from baker.align.up import upright
from baker.align.yaw import YawFit, kept_near, likely_yaws
from baker.vertical import Vertical

SAME_PLACE = 0.05  # of the plants' height: bases so near are the same
SAME_FRAME = 0.08  # of the share kept: what the scans' own frame may lose against the best yaws


@dataclass(frozen=True)
class Stand:
    """A scan set upright with its stem's base at the origin.

    frame:   (4, 4) from the scan's coordinates to these.
    sample:  in these.
    """

    frame: NDArray[np.float64]
    sample: EvenSample

    @property
    def base(self) -> NDArray[np.float64]:
        """(3,) in the scan's own coordinates."""
        return np.asarray(np.linalg.inv(self.frame)[:3, 3])

    @property
    def height(self) -> float:
        return float(np.ptp(self.sample.points[:, 2]))


def stand_at(sample: EvenSample, vertical: Vertical, base: NDArray[np.float64]) -> Stand:
    """The scan of which `sample` was taken, standing at its (3,) base."""
    turn = upright(vertical)
    frame = np.eye(4)
    frame[:3, :3], frame[:3, 3] = turn, -turn @ base
    moved = EvenSample((sample.pool - base) @ turn.T, (sample.points - base) @ turn.T, sample.radii)
    return Stand(frame, moved)


def best_stand(
    earlier: Stand, sample: EvenSample, vertical: Vertical
) -> tuple[Stand, list[YawFit]]:
    """The next scan at that of its possible bases which fits its predecessor, and likely yaws."""
    tries = []
    for base in stem_bases(sample, vertical):
        stand = stand_at(sample, vertical, base)
        tries.append((stand, likely_yaws(earlier.sample, stand.sample)))
    if len(tries) == 1:
        return tries[0]
    return min(
        tries,
        key=lambda tried: trimmed_residual(
            earlier.sample, tried[0].sample, _about_z(tried[1][0].yaw)
        ),
    )


def move(earlier: Stand, later: Stand, yaw: float) -> NDArray[np.float64]:
    """(4, 4) from the later scan's coordinates to the earlier's: base to base, turned by `yaw`."""
    return np.linalg.inv(earlier.frame) @ _about_z(yaw) @ later.frame


def stand_in_one_frame(stands: Sequence[Stand], yaws: Sequence[Sequence[YawFit]]) -> bool:
    """Whether a series came aligned: all bases in one place, and no other yaws are much better.

    One pair alone may fit the wrong way round by chance; that all do is no chance.
    """
    if not all(
        np.linalg.norm(earlier.base - later.base) <= SAME_PLACE * max(earlier.height, later.height)
        for earlier, later in pairwise(stands)
    ):
        return False
    lost = [
        likely[0].kept - kept_near(earlier.sample, later.sample, 0.0)
        for (earlier, later), likely in zip(pairwise(stands), yaws, strict=True)
    ]
    return float(np.mean(lost)) <= SAME_FRAME


def _about_z(yaw: float) -> NDArray[np.float64]:
    from scipy.spatial.transform import Rotation

    turn = np.eye(4)
    turn[:3, :3] = Rotation.from_euler("z", yaw, degrees=True).as_matrix()
    return turn
