"""Which scans of a series stand in one frame already, and on which base each one stands."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from baker.alignment.icp import trimmed_residual
from baker.alignment.pose import Stand, about_z, possible_stands
from baker.alignment.yaw import YawFit, kept_near, likely_yaws
from baker.geometry.parallel import MapLike
from baker.geometry.sampling import EvenSample
from baker.geometry.up_axis import Vertical

SAME_PLACE = 0.05  # of the plants' height: bases so near are the same
# Of the share kept, what the scans' own frame may lose against the best yaw: in most pairs, and in
# one pair of a series that came aligned.
SAME_FRAME, NO_JUMP = 0.08, 0.2


def best_stands(
    first: Stand,
    samples: Sequence[EvenSample],
    vertical: Vertical,
    map: MapLike = map,
) -> tuple[list[Stand], list[list[YawFit]]]:
    """Each further scan at that of its possible bases which fits its predecessor, likely yaws.

    The first scan's stand comes first; there are as many lists of yaws as samples.
    """
    further = list(map(partial(possible_stands, vertical=vertical), samples))
    possible = [[first], *further]
    # Where the predecessor's base is certain, nothing has to wait for it.
    certain = [
        (k, place) for k in range(len(samples)) if len(possible[k]) == 1
        for place in range(len(further[k]))
    ]  # fmt: skip
    earlier = [possible[k][0] for k, _ in certain]
    later = [further[k][place] for k, place in certain]
    known = dict(zip(certain, map(likely_yaws, earlier, later), strict=True))
    stands, yaws = [first], []
    for k, choices in enumerate(further):
        before = stands[-1]
        tries = [
            (stand, known[k, place] if (k, place) in known else likely_yaws(before, stand))
            for place, stand in enumerate(choices)
        ]
        stand, likely = tries[0] if len(tries) == 1 else min(tries, key=partial(_residual, before))
        stands.append(stand)
        yaws.append(likely)
    return stands, yaws


def _residual(earlier: Stand, tried: tuple[Stand, list[YawFit]]) -> float:
    stand, likely = tried
    return trimmed_residual(earlier.sample, stand.sample, about_z(likely[0].yaw))


def shared_frames(stands: Sequence[Stand], yaws: Sequence[Sequence[YawFit]]) -> NDArray[np.intp]:
    """(S,) a number for each scan; scans with the same number stand in one frame.

    A series came aligned if most scans have their base in one place, and most of those keep about
    as much of the one before as they could: one pair alone may fit better the wrong way round by
    chance. Where much is lost, or something twice in a row (as one jumped scan does it), and the
    scan doesn't fit the one before the last either, it has jumped, and stands alone.
    """
    count = len(stands)
    lost = [
        _lost_unturned(before, after, likely[0].kept)
        for (before, after), likely in zip(pairwise(stands), yaws, strict=True)
    ]
    alone = np.arange(count)
    in_place = _in_place(stands)
    in_row = np.sort(np.array(lost)[in_place[1:] & in_place[:-1]])
    if not len(in_row) or in_row[(len(in_row) - 1) // 2] > SAME_FRAME:
        return alone
    doubtful = np.concatenate([[False], np.array(lost) > SAME_FRAME, [False]])
    twice = doubtful[1:-1] & (doubtful[:-2] | doubtful[2:])
    broken = twice | (np.array(lost) > NO_JUMP)
    frames = alone.copy()
    for at in range(1, count):
        if not broken[at - 1]:
            frames[at] = frames[at - 1]
        elif at > 1:
            before, after = stands[at - 2], stands[at]
            if _lost_unturned(before, after, likely_yaws(before, after)[0].kept) <= SAME_FRAME:
                frames[at] = frames[at - 2]
    main = np.argmax(np.bincount(frames))
    return np.where(frames == main, count, alone)


def _in_place(stands: Sequence[Stand]) -> NDArray[np.bool_]:
    """(S,) whether a scan's base is where most have theirs; none is if there is no such place."""
    bases = np.array([stand.base for stand in stands])
    apart = np.linalg.norm(bases - np.median(bases, axis=0), axis=1)
    there = apart <= SAME_PLACE * max(stand.height for stand in stands)
    return there if 2 * there.sum() > len(stands) else np.zeros(len(stands), bool)


def _lost_unturned(earlier: Stand, later: Stand, best: float) -> float:
    """How much less is kept where the scans stand as they do than at the best yaw, at most 1."""
    apart = float(np.linalg.norm(earlier.base - later.base))
    if apart > SAME_PLACE * max(earlier.height, later.height):
        return 1.0
    return best - kept_near(earlier, later, 0.0)
