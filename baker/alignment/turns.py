"""How far each organ has turned about the stem between two scans, and what they agree on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.alignment.correspondence import CLOSELY, Around, at_one_spacing, pairs_of_least_cost
from baker.alignment.organs import AXIS
from baker.alignment.pose import Stand, about_z

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

    An organ points where its middle lies, seen from the stem.
    """
    turned = about_z(yaw)[:3, :3]
    before, after = earlier.sample.points, later.sample.points @ turned.T
    turns, levers, moment = [], [], 0.0
    for old, new in _same_organs(earlier, later, turned):
        mine = before[np.isin(earlier.organs.numbers, old)]
        theirs = after[np.isin(later.organs.numbers, new)]
        start, end = mine.mean(axis=0), theirs.mean(axis=0)
        lever = min(np.hypot(*start[:2]), np.hypot(*end[:2]))
        turn = np.degrees(np.arctan2(end[1], end[0]) - np.arctan2(start[1], start[0]))
        turn = (turn + 180.0) % 360.0 - 180.0
        reach = np.hypot(*mine[:, :2].T)
        if abs(turn) <= WIDEST and lever > CLEAR * reach.mean():
            turns.append(turn)
            levers.append(lever)
            moment += reach.sum()
    whole = np.hypot(*before[:, :2].T).sum()
    return np.array(turns), np.array(levers), float(moment / whole) if whole > 0 else 0.0


def _same_organs(
    earlier: Stand, later: Stand, turned: NDArray[np.float64]
) -> list[tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """Numbers of organs in the earlier and in the later scan that are the same.

    The points are paired one to one; organs are the same when most points of either have their
    partners in the other. What is one organ in one scan and several in the other is taken together.
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    before, after = at_one_spacing(earlier.sample, later.sample, CLOSELY.points)
    around = Around.stem(before), Around.stem(after @ turned.T)
    pairs = pairs_of_least_cost(*around, 0.0, CLOSELY.growth)
    old, new = earlier.organs.numbers[: len(before)], later.organs.numbers[: len(after)]
    count, more = old.max(initial=AXIS) + 1, new.max(initial=AXIS) + 1
    # The axis is counted as one further organ, and left out.
    shared = np.zeros((count + 1, more + 1))
    np.add.at(shared, (old[pairs.earlier], new[pairs.later]), 1.0)
    shared = shared[:-1, :-1]
    most_of_old = shared >= 0.5 * np.bincount(old + 1, minlength=count + 1)[1:, None]
    most_of_new = shared >= 0.5 * np.bincount(new + 1, minlength=more + 1)[1:]
    one, other = np.nonzero((shared > 0) & (most_of_old | most_of_new))
    links = coo_matrix((np.ones(len(one)), (one, count + other)), shape=(count + more,) * 2)
    _, organ = connected_components(links, directed=False)
    return [
        (np.flatnonzero(organ[:count] == same), np.flatnonzero(organ[count:] == same))
        for same in np.unique(organ[one])
    ]


def _median(values: NDArray[np.float64], weights: NDArray[np.float64]) -> float:
    """The weighted median, smoothed: small differences count by their squares (Weiszfeld)."""
    order = np.argsort(values, kind="stable")
    middle = int(np.searchsorted(np.cumsum(weights[order]), 0.5 * weights.sum()))
    found = float(values[order[min(middle, len(values) - 1)]])
    for _ in range(50):
        pull = weights / np.hypot(values - found, AGREED)
        found = float((pull * values).sum() / pull.sum())
    return found
