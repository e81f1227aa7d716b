"""Find the yaws by which scans are rotated about the stem, from the directions of the organs.

Yaws are in degrees, from the later scan to the earlier one, right-handed about +z.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from baker.alignment.pose import Pose

STEP = 5
YAWS = np.arange(0, 360, STEP)
TURN_WIDTHS = (20.0, 5.0)  # degrees, standard deviations of the turns of organs, coarse and fine
WEIGHT_OF_NEXT_BUT_ONE = 0.5  # of the fit of a scan to the one before the previous
MIN_SHARE_BY_LABEL = 0.7  # fit of organs paired by label : fit of organs paired freely
# The fit at a yaw has to exceed the fit at any other yaw so many degrees away by MIN_LEAD. It does
# not at 64 % of wrong yaws and 24 % of right ones (20 real series without labels).
MIN_OTHER_TURN, MIN_LEAD = 30.0, 0.2
MAX_CORRECTION = 10.0  # degrees, from a yaw of `YAWS` to the refined one
ITERATIONS, MIN_STEP = 20, 0.01

Curve = NDArray[np.float64]
"""(72,) fit at each of `YAWS`: share of the organs, by lever, that keep their direction"""


class YawFit(NamedTuple):
    """The fit of successive scans at all yaws."""

    by_label: bool  # whether organs were paired by their labels
    curves: list[Curve]  # from each scan to the previous one
    places: list[int]  # indices in `YAWS` of the yaws that fit the whole series best

    @property
    def gains(self) -> NDArray[np.float64]:
        """The fit of each scan at its yaw, minus that without a rotation."""
        pairs = zip(self.curves, self.places, strict=True)
        return np.array([curve[place] - curve[0] for curve, place in pairs])


def fit_yaws(poses: Sequence[Pose], labelled: bool) -> YawFit:
    """Find the yaws of a series. labelled: whether its organs have labels."""
    by_label = labelled and labels_are_names(poses)
    near, far = (
        [direction_curve(*pair, by_label) for pair in zip(poses, poses[step:], strict=False)]
        for step in (1, 2)
    )
    return YawFit(by_label, near, consistent_yaws(near, far))


def labels_are_names(poses: Sequence[Pose]) -> bool:
    """Whether an organ has the same label in all scans.

    If so, organs paired by label fit nearly as well, at some yaw, as organs paired freely; if the
    labels are random, half as well.
    """
    fits = np.zeros(2)
    for earlier, later in pairwise(poses):
        for k, by_label in enumerate((True, False)):
            fits[k] += max(
                _pair_fits(earlier, later, yaw, by_label)[0].sum() for yaw in YAWS[::2].tolist()
            )
    return bool(fits[0] > MIN_SHARE_BY_LABEL * fits[1])


def direction_curve(earlier: Pose, later: Pose, by_label: bool) -> Curve:
    """The share of the organs that keep their direction from the stem, at each of `YAWS`.

    Organs are paired by label, or by an optimal assignment. They are weighted by their lever, the
    horizontal distance of their centre from the stem. For a bare stem it is 1 at all yaws.
    """
    fits = np.array([_pair_fits(earlier, later, yaw, by_label)[0].sum() for yaw in YAWS.tolist()])
    levers = np.hypot(*earlier.centers[:, :2].T)
    if by_label:
        levers = levers[np.isin(earlier.names, later.names)]
    return fits / levers.sum() if levers.any() else np.ones(len(YAWS))


def exact_yaw(earlier: Pose, later: Pose, yaw: float, by_label: bool) -> float:
    """Refine a yaw to the nearby maximum of the fit by mean shift (Fukunaga 1975)."""
    low, high = yaw - MAX_CORRECTION, yaw + MAX_CORRECTION
    for width in TURN_WIDTHS:
        for _ in range(ITERATIONS):
            fits, turns = _pair_fits(earlier, later, yaw, by_label, width)
            step = float((fits * turns).sum() / fits.sum()) if fits.any() else 0.0
            yaw = min(max(yaw - step, low), high)
            if abs(step) < MIN_STEP:
                break
    return float(wrapped(np.array(yaw)))


def consistent_yaws(next: Sequence[Curve], next_but_one: Sequence[Curve]) -> list[int]:
    """The yaws from each scan to the previous one that fit the whole series best.

    A scan should fit the previous scan and the one before that: a scan that is rotated by mistake
    would fit neither its successor nor the next one. The best combination is found by dynamic
    programming over the directions of two successive scans.

    Parameters
    ----------
    next, next_but_one : sequences of Curve
        From each scan to the previous one, and to the one before that.

    Returns
    -------
    list of int
        Indices in `YAWS`.
    """
    count = len(YAWS)
    turn = np.subtract.outer(np.arange(count), np.arange(count)).T % count  # [previous, current]
    score = np.full((count, count), -np.inf)  # of the best series that ends in two directions
    score[0] = next[0]
    steps = []
    for to_previous, to_second in zip(next[1:], next_but_one, strict=True):
        total = score[:, :, None] + to_previous[turn]
        total = total + WEIGHT_OF_NEXT_BUT_ONE * to_second[turn][:, None]
        steps.append(total.argmax(axis=0))
        score = total.max(axis=0)
    previous, current = np.unravel_index(score.argmax(), score.shape)
    directions = [int(current), int(previous)]
    for step in reversed(steps):
        directions.append(int(step[directions[-1], directions[-2]]))
    return [(b - a) % count for a, b in pairwise(reversed(directions))]


def second_yaw(curve: Curve, place: int) -> float | None:
    """A further rotation in degrees at which a scan fits nearly as well as at its yaw, or None."""
    further = wrapped(YAWS - YAWS[place])
    elsewhere = np.where(np.abs(further) > MIN_OTHER_TURN, curve, -np.inf)
    best = int(np.argmax(elsewhere))
    return float(further[best]) if curve[place] - elsewhere[best] < MIN_LEAD else None


def wrapped(degrees: NDArray[Any]) -> NDArray[np.float64]:
    """Wrap angles to -180 to 180 degrees."""
    return (degrees + 180.0) % 360.0 - 180.0


def _pair_fits(
    earlier: Pose, later: Pose, yaw: float, by_label: bool, width: float = TURN_WIDTHS[0]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The fit of each pair of organs at a yaw, its lever times a Gaussian of its turn; the turns.

    So organs that turned, are new or lost don't count. The fit of organs that are paired freely is
    also reduced by their difference in height.
    """
    from scipy.optimize import linear_sum_assignment

    azimuths = [np.degrees(np.arctan2(c[:, 1], c[:, 0])) for c in (earlier.centers, later.centers)]
    levers = [np.hypot(c[:, 0], c[:, 1]) for c in (earlier.centers, later.centers)]
    turns = wrapped(azimuths[1] + yaw - azimuths[0][:, None])
    fits = np.minimum(levers[0][:, None], levers[1]) * np.exp(-0.5 * (turns / width) ** 2)
    if by_label:
        pairs = np.nonzero(earlier.names[:, None] == later.names)
    else:
        rise = later.centers[:, 2] - earlier.centers[:, 2][:, None]
        height = max(earlier.height, float(np.finfo(np.float32).tiny))
        fits *= np.exp(-0.5 * (rise / height) ** 2)
        pairs = linear_sum_assignment(-fits)
    return fits[pairs], turns[pairs]
