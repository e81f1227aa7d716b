"""How far a plant was turned about its stem between two scans."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.align.sample import EvenSample

TURN_KEPT = np.radians(12.0)  # an organ that turns by much more does not count as kept
NEAR = 0.1  # yaws that keep so nearly as much as the best one are also likely


@dataclass(frozen=True)
class Look:
    """How closely yaws are compared.

    points: of the larger sample.
    growth: what moving outwards or upwards costs, in units of moving sideways.
    """

    points: int
    growth: float


# Measured on 33 pairs of real scans: the wider look mistakes fewer leaves for one another, the
# narrower one is the more exact once they are told apart.
ALL_ROUND, CLOSELY = Look(200, 0.5), Look(350, 0.33)
ROUND_STEP, CLOSE_STEP, CLOSE_REACH = 10.0, 2.0, 14.0  # degrees


@dataclass(frozen=True)
class YawFit:
    """A yaw in degrees (later scan to earlier, right-handed about +z) and the share it keeps."""

    yaw: float
    kept: float


@dataclass(frozen=True)
class Around:
    """(n,) cylindrical coordinates about a stem: distance from its axis, azimuth and height."""

    radius: NDArray[np.float64]
    azimuth: NDArray[np.float64]
    height: NDArray[np.float64]

    @classmethod
    def stem(cls, points: NDArray[np.float64]) -> Around:
        """Of (n, 3) points with z up and the stem's base at the origin."""
        x, y, z = points.T
        return cls(np.hypot(x, y), np.arctan2(y, x), z)


def kept_share(earlier: Around, later: Around, yaw: float, growth: float) -> float:
    """The share (0 to 1) of the plant that keeps its direction from the stem at this yaw.

    Every point of the smaller sample is paired with one of its own in the other, by the assignment
    of least cost. Plants grow outwards and upwards, so that costs less than a way around the stem.
    A pair counts by its distance from the stem (as an arm's moment does) and with a Gaussian of
    its turn: turned, new and lost organs then weigh nothing instead of pulling.
    """
    from scipy.optimize import linear_sum_assignment

    turn = later.azimuth + np.radians(yaw) - earlier.azimuth[:, None]
    turn = (turn + np.pi) % (2.0 * np.pi) - np.pi
    moment = earlier.radius[:, None] * later.radius
    grown = (earlier.radius[:, None] - later.radius) ** 2
    grown += (earlier.height[:, None] - later.height) ** 2
    pairs = linear_sum_assignment(moment * turn**2 + growth**2 * grown)
    weights = np.sqrt(moment[pairs])
    total = weights.sum()
    if total == 0.0:
        return 1.0
    return float((weights * np.exp(-0.5 * (turn[pairs] / TURN_KEPT) ** 2)).sum() / total)


def likely_yaws(earlier: EvenSample, later: EvenSample) -> list[YawFit]:
    """The directions that keep nearly as much of the plant as the best does, best first.

    All of the circle is looked at, in steps of 10 degrees. Both samples have z up and the stem's
    base at the origin. A bare stem keeps everything at every yaw: then 0 is the only answer.
    """
    samples = _at_one_spacing(earlier, later, ALL_ROUND.points)
    yaws = np.arange(-180.0, 180.0, ROUND_STEP)
    kept = np.array([kept_share(*samples, yaw, ALL_ROUND.growth) for yaw in yaws])
    peak = (kept >= np.roll(kept, 1)) & (kept > np.roll(kept, -1)) & (kept >= kept.max() - NEAR)
    fits = [YawFit(float(yaws[at]), float(kept[at])) for at in np.flatnonzero(peak)]
    return sorted(fits, key=lambda fit: -fit.kept) or [YawFit(0.0, float(kept.max()))]


def kept_near(earlier: EvenSample, later: EvenSample, yaw: float) -> float:
    """The most that `likely_yaws` could find within a step of `yaw`."""
    samples = _at_one_spacing(earlier, later, ALL_ROUND.points)
    yaws = yaw + ROUND_STEP * np.arange(-1, 2)
    return max(kept_share(*samples, near, ALL_ROUND.growth) for near in yaws)


def exact_yaw(earlier: EvenSample, later: EvenSample, near: float) -> YawFit:
    """The yaw about `near` that keeps most: the top of a parabola through the best shares."""
    samples = _at_one_spacing(earlier, later, CLOSELY.points)
    yaws = near + np.arange(-CLOSE_REACH, CLOSE_REACH + CLOSE_STEP, CLOSE_STEP)
    kept = np.array([kept_share(*samples, yaw, CLOSELY.growth) for yaw in yaws])
    best = int(np.lexsort((np.abs(yaws - near), -kept.round(9)))[0])
    about = slice(max(best - 3, 0), best + 4)
    bend, slope, _ = np.polyfit(yaws[about] - yaws[best], kept[about], 2)
    top = float(np.clip(-slope / (2.0 * bend), -CLOSE_STEP, CLOSE_STEP)) if bend < 0 else 0.0
    return YawFit((yaws[best] + top + 180.0) % 360.0 - 180.0, float(kept[best]))


def _at_one_spacing(earlier: EvenSample, later: EvenSample, most: int) -> tuple[Around, Around]:
    """Both samples equally dense: a plant that has grown has more points, not all are needed."""
    spacing = max(sample.radii[:most][-1] for sample in (earlier, later))
    return Around.stem(earlier.within(spacing)), Around.stem(later.within(spacing))
