"""Find the yaws by which scans are rotated about the stem, from the directions of the organs.

Yaws are in degrees, from the later scan to the earlier one, right-handed about +z.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from baker.alignment.pose import Pose

YAWS = np.arange(0, 360, 5)  # degrees, at which scans are compared first
WIDTH, FINE_WIDTH = 20.0, 5.0  # degrees, standard deviations of the Gaussian of organs' turns
MIN_SHARE_BY_LABEL = 0.7  # ratio of the fit of organs paired by label to that paired freely
# A yaw is doubtful unless its fit exceeds that at all yaws at least MIN_OTHER_TURN degrees away by
# MIN_LEAD: 64 % of wrong yaws are, and 24 % of right ones (20 real series without labels).
MIN_OTHER_TURN, MIN_LEAD = 30.0, 0.2
# Degrees from a yaw of `YAWS` to refined ones, the smallest first.
FINE_STEPS = np.array(sorted(np.arange(-10.0, 10.5, 0.5), key=abs))

Curve = NDArray[np.float64]
"""(72,) fit at each of `YAWS`: the share of organs, weighted by their distance from the stem, that
keep their direction"""


class YawFit(NamedTuple):
    """The fit of successive scans at all yaws."""

    by_label: bool  # whether organs were paired by their labels
    curves: list[Curve]  # from each scan to the previous one

    @property
    def yaw_indices(self) -> list[int]:
        """The indices in `YAWS` of the yaws that fit best."""
        return [int(curve.argmax()) for curve in self.curves]

    @property
    def gains(self) -> NDArray[np.float64]:
        """The fit of each scan at its yaw, minus that without a rotation."""
        return np.array([curve.max() - curve[0] for curve in self.curves])

    @property
    def distinction(self) -> float:
        """By how many standard deviations scans fit better as given than at all yaws, on average.

        It is about 0 if scans were rotated at random, and infinite if all yaws fit alike.
        """
        curves = [curve for curve in self.curves if np.ptp(curve) > 0.0]
        scores = [(curve[0] - curve.mean()) / curve.std() for curve in curves]
        return float(np.mean(scores)) if scores else np.inf


def fit_yaws(poses: Sequence[Pose], labelled: bool) -> YawFit:
    """Compute the fit of each scan of a series to the previous one at all yaws.

    Organs are paired by label if all scans are `labelled` and if that fits nearly as well, at some
    yaw, as pairing them freely. It fits half as well if the labels are random.
    """
    fits = [
        YawFit(by_label, [direction_curve(*pair, by_label) for pair in pairwise(poses)])
        for by_label in (False, True)[: 1 + labelled]
    ]
    free, best = (sum(curve.max() for curve in fit.curves) for fit in (fits[0], fits[-1]))
    return fits[-1] if best > MIN_SHARE_BY_LABEL * free else fits[0]


def direction_curve(earlier: Pose, later: Pose, by_label: bool) -> Curve:
    """The share of the organs that keep their direction from the stem, at each of `YAWS`.

    Organs are paired by label, or by an optimal assignment. They are weighted by their lever, the
    horizontal distance of their centre from the stem. For a bare stem it is 1 at all yaws.
    """
    fits = _fits(earlier, later, YAWS, by_label)
    levers = np.hypot(*earlier.centers[:, :2].T)
    return fits / levers.sum() if levers.any() else np.ones(len(YAWS))


def refined_yaw(earlier: Pose, later: Pose, yaw: float, by_label: bool) -> float:
    """Refine a yaw to the nearby one, in steps of half a degree, at which organs fit best."""
    yaws = wrapped(yaw + FINE_STEPS)
    return float(yaws[np.argmax(_fits(earlier, later, yaws, by_label, FINE_WIDTH))])


def second_yaw(curve: Curve, index: int) -> float | None:
    """A further rotation in degrees at which a scan fits nearly as well as at its yaw, or None."""
    further = wrapped(YAWS - YAWS[index])
    elsewhere = np.where(np.abs(further) > MIN_OTHER_TURN, curve, -np.inf)
    best = int(np.argmax(elsewhere))
    return float(further[best]) if curve[index] - elsewhere[best] < MIN_LEAD else None


def wrapped(degrees: NDArray[Any]) -> NDArray[np.float64]:
    """Wrap angles to -180 to 180 degrees."""
    return (degrees + 180.0) % 360.0 - 180.0


def _fits(
    earlier: Pose, later: Pose, yaws: NDArray[Any], by_label: bool, width: float = WIDTH
) -> Curve:
    """The fit at each yaw: the sum over pairs of organs of lever times a Gaussian of their turn.

    So organs that have turned about the stem, are new or lost contribute nothing. The fit of organs
    that are paired freely is also multiplied by a Gaussian of their difference in height.
    """
    from scipy.optimize import linear_sum_assignment

    azimuths = [np.degrees(np.arctan2(c[:, 1], c[:, 0])) for c in (earlier.centers, later.centers)]
    levers = [np.hypot(c[:, 0], c[:, 1]) for c in (earlier.centers, later.centers)]
    turns = wrapped(azimuths[1] + yaws[:, None, None] - azimuths[0][:, None])
    fits = np.minimum(levers[0][:, None], levers[1]) * np.exp(-0.5 * (turns / width) ** 2)
    if by_label:
        return fits[:, earlier.names[:, None] == later.names].sum(axis=1)
    rise = later.centers[:, 2] - earlier.centers[:, 2][:, None]
    height = max(earlier.height, float(np.finfo(np.float32).tiny))
    fits *= np.exp(-0.5 * (rise / height) ** 2)
    return np.array([fit[linear_sum_assignment(-fit)].sum() for fit in fits])
