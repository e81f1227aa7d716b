"""How far each organ has turned about the stem between two scans, and what they agree on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.align.organs import AXIS
from baker.align.points import CLOSELY, Around, at_one_spacing, pairs_of_least_cost
from baker.align.stand import Stand, about_z

WIDEST = 45.0  # degrees; what turns by more is another organ
CLEAR = 0.5  # of its points' mean distance from the stem: the middle of an organ that points away
AGREED = 1.0  # degrees: turns that differ by much less are averaged
ENOUGH = 0.6  # of the plant's moment: organs that speak for all of it
ROUNDS, NEAR_ENOUGH = 4, 0.05


def organ_yaw(earlier: Stand, later: Stand, near: float) -> float | None:
    """The yaw in degrees about `near` at which the organs have turned least, or None.

    Organs vote with their length of lever: a weighted median of their turns, so that the long and
    steady ones decide and one that turns alone doesn't. None where few organs are told apart.
    """
    yaw = near
    for _ in range(ROUNDS):
        turns, levers, share = organ_turns(earlier, later, yaw)
        if share < ENOUGH:
            return None
        turn = _median(turns, levers)
        yaw -= turn
        if abs(turn) < NEAR_ENOUGH:
            break
    return (yaw + 180.0) % 360.0 - 180.0


def organ_turns(
    earlier: Stand, later: Stand, yaw: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Each organ's turn beyond `yaw` in degrees, its lever, and what share of the plant they are.

    The points are paired one to one; organs are the same when most points of either have their
    partners in the other. What is one organ in one scan and several in the other is taken together.
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    before, after = at_one_spacing(earlier.sample, later.sample, CLOSELY.points)
    turned = about_z(yaw)[:3, :3]
    after = after @ turned.T
    rows, columns = pairs_of_least_cost(
        Around.stem(before), Around.stem(after), 0.0, CLOSELY.growth
    )
    of_before = earlier.organs.numbers[: len(before)]
    of_after = later.organs.numbers[: len(after)]
    count, more = of_before.max(initial=AXIS) + 1, of_after.max(initial=AXIS) + 1
    shared = np.zeros((count, more))
    in_both = (of_before[rows] != AXIS) & (of_after[columns] != AXIS)
    np.add.at(shared, (of_before[rows[in_both]], of_after[columns[in_both]]), 1.0)
    most_of_before = (
        shared >= 0.5 * np.bincount(of_before[of_before != AXIS], minlength=count)[:, None]
    )
    most_of_after = shared >= 0.5 * np.bincount(of_after[of_after != AXIS], minlength=more)
    one, other = np.nonzero((shared > 0) & (most_of_before | most_of_after))
    links = coo_matrix((np.ones(len(one)), (one, count + other)), shape=(count + more,) * 2)
    _, organ = connected_components(links, directed=False)
    whole_before, whole_after = earlier.sample.points, later.sample.points @ turned.T
    turns, levers, moment = [], [], 0.0
    for number in np.unique(organ[one]):
        mine = whole_before[
            np.isin(earlier.organs.numbers, np.flatnonzero(organ[:count] == number))
        ]
        theirs = whole_after[np.isin(later.organs.numbers, np.flatnonzero(organ[count:] == number))]
        start, end = (points.mean(axis=0) for points in (mine, theirs))
        lever = min(np.hypot(*start[:2]), np.hypot(*end[:2]))
        turn = np.degrees(np.arctan2(end[1], end[0]) - np.arctan2(start[1], start[0]))
        turn = (turn + 180.0) % 360.0 - 180.0
        reach = np.hypot(*mine[:, :2].T)
        if abs(turn) <= WIDEST and lever > CLEAR * reach.mean():
            turns.append(turn)
            levers.append(lever)
            moment += reach.sum()
    whole = np.hypot(*whole_before[:, :2].T).sum()
    return np.array(turns), np.array(levers), moment / whole if whole > 0 else 0.0


def _median(values: NDArray[np.float64], weights: NDArray[np.float64]) -> float:
    """The weighted median, smoothed: small differences count by their squares (Weiszfeld)."""
    order = np.argsort(values, kind="stable")
    middle = int(np.searchsorted(np.cumsum(weights[order]), 0.5 * weights.sum()))
    found = float(values[order[min(middle, len(values) - 1)]])
    for _ in range(50):
        pull = weights / np.hypot(values - found, AGREED)
        found = float((pull * values).sum() / pull.sum())
    return found
