"""How far a plant was turned about its stem between two scans."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from baker.alignment.correspondence import (
    COARSE_GROWTH,
    COARSE_POINTS,
    FINE_GROWTH,
    FINE_POINTS,
    TURN_WIDTH,
    Cylindrical,
    at_one_spacing,
    direction_overlap,
    pairs_of_least_cost,
)
from baker.alignment.pose import AXIS, Pose, about_z

# Overlap that a likely yaw may lack of the best one's: when it is found exactly, and before, when
# some are five degrees off and others hit upon.
LIKELY_LOSS, CANDIDATE_LOSS = 0.1, 0.15
COARSE_STEP, FINE_STEP, FINE_RANGE = 10.0, 2.0, 14.0  # degrees
MAX_TURN = 45.0  # degrees; what turns by more is another organ
# Distance of an organ's middle from the stem, over its points' mean one: an organ that points away.
MIN_LEVER_RATIO = 0.5
AVERAGED_TURN = 1.0  # degrees: turns that differ by much less are averaged
MIN_MOMENT_SHARE = 0.6  # of the plant's moment: organs that speak for all of it
MAX_ROUNDS, MIN_STEP = 4, 0.05
MEDIAN_ITERATIONS = 50


class YawFit(NamedTuple):
    """A yaw in degrees, later scan to earlier, right-handed about +z, and the overlap there."""

    yaw: float
    overlap: float


def likely_yaws(earlier: Pose, later: Pose) -> list[YawFit]:
    """The yaws of nearly the largest overlap, exactly, the best first.

    All of the circle is searched in steps of 10 degrees, and then finely about the local maxima. A
    bare stem overlaps at every yaw: then 0 is the only answer.
    """
    yaws = np.arange(-180.0, 180.0, COARSE_STEP)
    overlaps = _overlaps(earlier, later, yaws)
    peak = (overlaps >= np.roll(overlaps, 1)) & (overlaps > np.roll(overlaps, -1))
    peak &= overlaps >= overlaps.max() - CANDIDATE_LOSS
    exact = [exact_yaw(earlier, later, float(yaw)) for yaw in yaws[peak]] or [0.0]
    fits = map(YawFit, exact, _overlaps(earlier, later, np.array(exact)).tolist())
    best, *others = sorted(fits, key=lambda fit: -fit.overlap)
    likely = [fit for fit in others if fit.overlap >= best.overlap - LIKELY_LOSS]
    return [best, *(f for f in likely if abs(wrapped(f.yaw - best.yaw)) > COARSE_STEP)]


def overlap_near(earlier: Pose, later: Pose, yaw: float) -> float:
    """The largest overlap that `likely_yaws` could find within a step of `yaw`."""
    return float(_overlaps(earlier, later, yaw + COARSE_STEP * np.arange(-1, 2)).max())


def exact_yaw(earlier: Pose, later: Pose, near: float) -> float:
    """The yaw in degrees about `near` at which organs turn least, or else points do.

    Of the points it is the top of a parabola through the best shares kept.
    """
    if (found := organ_yaw(earlier, later, near)) is not None:
        return found
    points = at_one_spacing(earlier.sample, later.sample, FINE_POINTS)
    before, after = (Cylindrical.about_stem(each) for each in points)
    yaws = near + np.arange(-FINE_RANGE, FINE_RANGE + FINE_STEP, FINE_STEP)
    kept = np.array([direction_overlap(before, after, yaw, FINE_GROWTH) for yaw in yaws])
    best = int(np.lexsort((np.abs(yaws - near), -kept.round(9)))[0])
    about = slice(max(best - 3, 0), best + 4)
    bend, slope, _ = np.polyfit(yaws[about] - yaws[best], kept[about], 2)
    top = float(np.clip(-slope / (2.0 * bend), -FINE_STEP, FINE_STEP)) if bend < 0 else 0.0
    return wrapped(yaws[best] + top)


def organ_overlap(earlier: Pose, later: Pose, yaw: float) -> float:
    """The share (0 to 1) of the organs' levers that keeps its direction from the stem.

    Organs are paired so that most is kept; one that is found far higher or lower counts less.
    """
    from scipy.optimize import linear_sum_assignment

    before, after = (Cylindrical.about_stem(pose.organs.centers) for pose in (earlier, later))
    turn = after.azimuth + np.radians(yaw) - before.azimuth[:, None]
    turn = (turn + np.pi) % (2.0 * np.pi) - np.pi
    kept = np.minimum(before.radius[:, None], after.radius)
    with np.errstate(over="ignore"):  # a plant of no height keeps what is level, and nothing else
        climb = (after.height - before.height[:, None]) / max(earlier.height, np.finfo(float).tiny)
        kept = kept * np.exp(-0.5 * ((turn / TURN_WIDTH) ** 2 + climb**2))
    total = before.radius.sum()
    return float(kept[linear_sum_assignment(-kept)].sum() / total) if total > 0.0 else 1.0


def wrapped(degrees: float) -> float:
    """The same direction between -180 and 180 degrees."""
    return float((degrees + 180.0) % 360.0 - 180.0)


def _overlaps(earlier: Pose, later: Pose, yaws: NDArray[np.floating]) -> NDArray[np.float64]:
    """(n,) how much stays at each yaw: the mean share of the points and of the organs."""
    points = at_one_spacing(earlier.sample, later.sample, COARSE_POINTS)
    before, after = (Cylindrical.about_stem(each) for each in points)
    overlaps = [
        direction_overlap(before, after, yaw, COARSE_GROWTH) + organ_overlap(earlier, later, yaw)
        for yaw in yaws
    ]
    return np.array(overlaps) / 2.0


def organ_yaw(earlier: Pose, later: Pose, near: float) -> float | None:
    """The yaw in degrees about `near` at which the organs have turned least, or None.

    Organs vote with their length of lever: a weighted median of their turns, so that the long and
    steady ones decide and one that turns alone doesn't. None where few organs are told apart.
    """
    yaw = near
    for _ in range(MAX_ROUNDS):
        turns, levers, share = organ_turns(earlier, later, yaw)
        if share < MIN_MOMENT_SHARE:
            return None
        turn = _median(turns, levers)
        yaw -= turn
        if abs(turn) < MIN_STEP:
            break
    return wrapped(yaw)


def organ_turns(
    earlier: Pose, later: Pose, yaw: float
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
        turn = wrapped(np.degrees(np.arctan2(end[1], end[0]) - np.arctan2(start[1], start[0])))
        reach = np.hypot(*mine[:, :2].T)
        if abs(turn) <= MAX_TURN and lever > MIN_LEVER_RATIO * reach.mean():
            turns.append(turn)
            levers.append(lever)
            moment += reach.sum()
    whole = np.hypot(*before[:, :2].T).sum()
    return np.array(turns), np.array(levers), float(moment / whole) if whole > 0 else 0.0


def _same_organs(
    earlier: Pose, later: Pose, turned: NDArray[np.float64]
) -> list[tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """Numbers of organs in the earlier and in the later scan that are the same.

    The points are paired one to one; organs are the same when most points of either have their
    partners in the other. What is one organ in one scan and several in the other is taken together.
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    before, after = at_one_spacing(earlier.sample, later.sample, FINE_POINTS)
    around = Cylindrical.about_stem(before), Cylindrical.about_stem(after @ turned.T)
    pairs = pairs_of_least_cost(*around, 0.0, FINE_GROWTH)
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
    found = float(np.quantile(values, 0.5, weights=weights, method="inverted_cdf"))
    for _ in range(MEDIAN_ITERATIONS):
        pull = weights / np.hypot(values - found, AVERAGED_TURN)
        found = float((pull * values).sum() / pull.sum())
    return found
