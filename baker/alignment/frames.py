"""Which scans of a series stand in one frame already, and on which base each one stands."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from baker.alignment.icp import trimmed_residual
from baker.alignment.pose import Pose, about_z, candidate_poses
from baker.alignment.sample import EvenSample
from baker.alignment.yaw import YawFit, likely_yaws, overlap_near
from baker.geometry.parallel import MapLike
from baker.geometry.up_axis import Vertical

MAX_BASE_OFFSET = 0.05  # of the plants' height: bases so near are the same
# Overlap that the scans' own frame may lose against the best yaw: in most pairs, and in one pair of
# a series that came aligned.
MAX_MEDIAN_LOSS, MAX_LOSS = 0.08, 0.2


def best_poses(
    first: Pose, samples: Sequence[EvenSample], vertical: Vertical, map: MapLike = map
) -> tuple[list[Pose], list[list[YawFit]]]:
    """Each further scan in that of its possible bases which fits its predecessor, likely yaws.

    The first scan's pose comes first; there are as many lists of yaws as samples.
    """
    further = list(map(partial(candidate_poses, vertical=vertical), samples))
    possible = [[first], *further]
    # Where the predecessor's base is certain, nothing has to wait for it.
    certain = [
        (k, place) for k in range(len(samples)) if len(possible[k]) == 1
        for place in range(len(further[k]))
    ]  # fmt: skip
    earlier = [possible[k][0] for k, _ in certain]
    later = [further[k][place] for k, place in certain]
    known = dict(zip(certain, map(likely_yaws, earlier, later), strict=True))
    poses, yaws = [first], []
    for k, choices in enumerate(further):
        before = poses[-1]
        tries = [
            (pose, known[k, place] if (k, place) in known else likely_yaws(before, pose))
            for place, pose in enumerate(choices)
        ]
        pose, likely = tries[0] if len(tries) == 1 else min(tries, key=partial(_residual, before))
        poses.append(pose)
        yaws.append(likely)
    return poses, yaws


def _residual(earlier: Pose, tried: tuple[Pose, list[YawFit]]) -> float:
    pose, likely = tried
    return trimmed_residual(earlier.sample, pose.sample, about_z(likely[0].yaw))


def shared_frames(poses: Sequence[Pose], yaws: Sequence[Sequence[YawFit]]) -> NDArray[np.intp]:
    """(S,) a number for each scan; scans with the same number stand in one frame.

    A series came aligned if most scans have their base in one place, and most of those keep about
    as much of the one before as they could: one pair alone may fit better the wrong way round by
    chance. Where much is lost, or something twice in a row (as one jumped scan does it), and the
    scan doesn't fit the one before the last either, it has jumped, and stands alone.
    """
    count = len(poses)
    lost = [
        _overlap_lost(before, after, likely[0].overlap)
        for (before, after), likely in zip(pairwise(poses), yaws, strict=True)
    ]
    alone = np.arange(count)
    in_place = _in_place(poses)
    in_row = np.sort(np.array(lost)[in_place[1:] & in_place[:-1]])
    if not len(in_row) or in_row[(len(in_row) - 1) // 2] > MAX_MEDIAN_LOSS:
        return alone
    doubtful = np.concatenate([[False], np.array(lost) > MAX_MEDIAN_LOSS, [False]])
    twice = doubtful[1:-1] & (doubtful[:-2] | doubtful[2:])
    broken = twice | (np.array(lost) > MAX_LOSS)
    frames = alone.copy()
    for at in range(1, count):
        if not broken[at - 1]:
            frames[at] = frames[at - 1]
        elif at > 1:
            before, after = poses[at - 2], poses[at]
            best = likely_yaws(before, after)[0].overlap
            if _overlap_lost(before, after, best) <= MAX_MEDIAN_LOSS:
                frames[at] = frames[at - 2]
    main = np.argmax(np.bincount(frames))
    return np.where(frames == main, count, alone)


def _in_place(poses: Sequence[Pose]) -> NDArray[np.bool_]:
    """(S,) whether a scan's base is where most have theirs; none is if there is no such place."""
    bases = np.array([pose.base for pose in poses])
    offsets = np.linalg.norm(bases - np.median(bases, axis=0), axis=1)
    in_place = offsets <= MAX_BASE_OFFSET * max(pose.height for pose in poses)
    return in_place if 2 * in_place.sum() > len(poses) else np.zeros(len(poses), bool)


def _overlap_lost(earlier: Pose, later: Pose, best: float) -> float:
    """How much less the overlap is where the scans stand as they do than at the best yaw."""
    distance = float(np.linalg.norm(earlier.base - later.base))
    if distance > MAX_BASE_OFFSET * max(earlier.height, later.height):
        return 1.0
    return best - overlap_near(earlier, later, 0.0)
