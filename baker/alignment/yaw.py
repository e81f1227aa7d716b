"""How far a plant was turned about its stem between scans, by where its organs point.

Yaws are in degrees, from the later scan to the earlier, right-handed about +z.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from baker.alignment.pose import Pose

STEP = 5
YAWS = np.arange(0, 360, STEP)
TURN_WIDTHS = (20.0, 5.0)  # standard deviations of organs' own turns, coarse and fine
WEIGHT_OF_NEXT_BUT_ONE = 0.5  # of how well a scan fits the one before the last
MIN_SHARE_BY_LABEL = 0.7  # of what keeps its direction among organs of any label
# Degrees from another yaw, and share kept more than there: of wrong yaws 64 % have less, of others
# 24 % (20 real series without labels).
MIN_OTHER_TURN, MIN_LEAD = 30.0, 0.2
MAX_CORRECTION = 10.0  # degrees, of a yaw that fits the whole series
ITERATIONS, MIN_STEP = 20, 0.01

Curve = NDArray[np.float64]
"""(72,) share of the organs' levers that keeps its direction at each of `YAWS`"""


class YawFit(NamedTuple):
    """How well successive scans fit each other, turned."""

    by_label: bool  # organs were paired by their labels
    curves: list[Curve]  # from each scan to the one before
    places: list[int]  # in YAWS, of the yaws that fit the whole series best

    @property
    def gains(self) -> NDArray[np.float64]:
        """What each scan gains by being turned on its predecessor."""
        pairs = zip(self.curves, self.places, strict=True)
        return np.array([curve[place] - curve[0] for curve, place in pairs])


def fit_yaws(poses: Sequence[Pose], labelled: bool) -> YawFit:
    """The yaws of a series; labelled: its organs have labels."""
    by_label = labelled and labels_are_names(poses)
    near, far = (
        [direction_curve(*pair, by_label) for pair in zip(poses, poses[step:], strict=False)]
        for step in (1, 2)
    )
    return YawFit(by_label, near, consistent_yaws(near, far))


def labels_are_names(poses: Sequence[Pose]) -> bool:
    """Whether the same label means the same organ throughout.

    Then organs of the same label keep their directions, at some yaw, nearly as well as organs
    paired freely do; where labels are numbered at random, half as well.
    """
    kept = np.zeros(2)
    for earlier, later in pairwise(poses):
        for way, by_label in enumerate((True, False)):
            kept[way] += max(
                _kept(earlier, later, yaw, by_label)[0].sum() for yaw in YAWS[::2].tolist()
            )
    return bool(kept[0] > MIN_SHARE_BY_LABEL * kept[1])


def direction_curve(earlier: Pose, later: Pose, by_label: bool) -> Curve:
    """What keeps its direction from the stem, at each of `YAWS`.

    Organs are paired by their labels, or so that most is kept; each counts by its lever, the
    distance of its middle from the stem. A bare stem keeps all at any yaw, and 0 is taken.
    """
    kept = np.array([_kept(earlier, later, yaw, by_label)[0].sum() for yaw in YAWS.tolist()])
    levers = np.hypot(*earlier.centers[:, :2].T)
    if by_label:
        levers = levers[np.isin(earlier.names, later.names)]
    return kept / levers.sum() if levers.any() else np.ones(len(YAWS))


def exact_yaw(earlier: Pose, later: Pose, yaw: float, by_label: bool) -> float:
    """The yaw next to `yaw` at which most keeps its direction (mean shift, Fukunaga 1975)."""
    low, high = yaw - MAX_CORRECTION, yaw + MAX_CORRECTION
    for width in TURN_WIDTHS:
        for _ in range(ITERATIONS):
            kept, turns = _kept(earlier, later, yaw, by_label, width)
            step = float((kept * turns).sum() / kept.sum()) if kept.any() else 0.0
            yaw = min(max(yaw - step, low), high)
            if abs(step) < MIN_STEP:
                break
    return float(wrapped(np.array(yaw)))


def consistent_yaws(next: Sequence[Curve], next_but_one: Sequence[Curve]) -> list[int]:
    """The yaws from each scan to the one before that fit the whole series best, as places in YAWS.

    A scan has to fit the one before it and the one before that: one that is turned by mistake would
    fit neither its successor nor the next one. Of all combinations the best is found exactly, by
    dynamic programming over the directions of two successive scans.
    """
    count = len(YAWS)
    turn = np.subtract.outer(np.arange(count), np.arange(count)).T % count  # [before, after]
    score = np.full((count, count), -np.inf)  # of the best series that ends in these two directions
    score[0] = next[0]
    steps = []
    for near, far in zip(next[1:], next_but_one, strict=True):
        tried = score[:, :, None] + near[turn] + WEIGHT_OF_NEXT_BUT_ONE * far[turn][:, None]
        steps.append(tried.argmax(axis=0))
        score = tried.max(axis=0)
    before, after = np.unravel_index(score.argmax(), score.shape)
    places = [int(after), int(before)]
    for step in reversed(steps):
        places.append(int(step[places[-1], places[-2]]))
    return [(b - a) % count for a, b in pairwise(reversed(places))]


def second_yaw(curve: Curve, place: int) -> float | None:
    """How much further a scan might be turned, where it would fit nearly as well; else None."""
    further = wrapped(YAWS - YAWS[place])
    elsewhere = np.where(np.abs(further) > MIN_OTHER_TURN, curve, -np.inf)
    best = int(np.argmax(elsewhere))
    return float(further[best]) if curve[place] - elsewhere[best] < MIN_LEAD else None


def wrapped(degrees: NDArray[Any]) -> NDArray[np.float64]:
    """The same directions between -180 and 180 degrees."""
    return (degrees + 180.0) % 360.0 - 180.0


def _kept(
    earlier: Pose, later: Pose, yaw: float, by_label: bool, width: float = TURN_WIDTHS[0]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Of each pair of organs: how much of its lever keeps its direction, and its turn in degrees.

    A Gaussian of the turn: turned, new and lost organs weigh nothing instead of pulling. Organs
    that are paired freely count less if they are found far higher or lower.
    """
    from scipy.optimize import linear_sum_assignment

    before, after = earlier.centers, later.centers
    azimuths = [np.degrees(np.arctan2(c[:, 1], c[:, 0])) for c in (before, after)]
    levers = [np.hypot(c[:, 0], c[:, 1]) for c in (before, after)]
    turns = wrapped(azimuths[1] + yaw - azimuths[0][:, None])
    kept = np.minimum(levers[0][:, None], levers[1]) * np.exp(-0.5 * (turns / width) ** 2)
    if by_label:
        pairs = np.nonzero(earlier.names[:, None] == later.names)
    else:
        climb = after[:, 2] - before[:, 2][:, None]
        height = max(earlier.height, float(np.finfo(np.float32).tiny))
        kept *= np.exp(-0.5 * (climb / height) ** 2)
        pairs = linear_sum_assignment(-kept)
    return kept[pairs], turns[pairs]
