"""How far a plant was turned about its stem between two scans."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.alignment.correspondence import (
    ALL_ROUND,
    CLOSELY,
    TURN_KEPT,
    Around,
    at_one_spacing,
    kept_share,
)
from baker.alignment.pose import Stand
from baker.alignment.turns import organ_yaw

# Yaws that keep so nearly as much as the best one are also likely; before they are found exactly,
# when some are five degrees off and others hit upon, they may be.
NEAR, PROMISING = 0.1, 0.15
ROUND_STEP, CLOSE_STEP, CLOSE_REACH = 10.0, 2.0, 14.0  # degrees


@dataclass(frozen=True)
class YawFit:
    """A yaw in degrees (later scan to earlier, right-handed about +z) and the share it keeps."""

    yaw: float
    kept: float


def likely_yaws(earlier: Stand, later: Stand) -> list[YawFit]:
    """The yaws that keep nearly as much of the plant as the best does, exactly, the best first.

    All of the circle is looked at, in steps of 10 degrees; what looks promising is looked at
    closely. A bare stem keeps everything at every yaw: then 0 is the only answer.
    """
    yaws = np.arange(-180.0, 180.0, ROUND_STEP)
    kept = _kept(earlier, later, yaws)
    peak = (kept >= np.roll(kept, 1)) & (kept > np.roll(kept, -1))
    peak &= kept >= kept.max() - PROMISING
    exact = [exact_yaw(earlier, later, float(yaw)) for yaw in yaws[peak]] or [0.0]
    fits = [
        YawFit(yaw, float(share))
        for yaw, share in zip(exact, _kept(earlier, later, np.array(exact)), strict=True)
    ]
    best, *others = sorted(fits, key=lambda fit: -fit.kept)
    near = [
        fit
        for fit in others
        if fit.kept >= best.kept - NEAR and abs(difference(fit.yaw, best.yaw)) > ROUND_STEP
    ]
    return [best, *near]


def kept_near(earlier: Stand, later: Stand, yaw: float) -> float:
    """The most that `likely_yaws` could find within a step of `yaw`."""
    return float(_kept(earlier, later, yaw + ROUND_STEP * np.arange(-1, 2)).max())


def exact_yaw(earlier: Stand, later: Stand, near: float) -> float:
    """The yaw in degrees about `near` at which organs turn least, or else points do.

    Of the points it is the top of a parabola through the best shares kept.
    """
    found = organ_yaw(earlier, later, near)
    if found is not None:
        return found
    points = (
        Around.stem(each) for each in at_one_spacing(earlier.sample, later.sample, CLOSELY.points)
    )
    before, after = points
    yaws = near + np.arange(-CLOSE_REACH, CLOSE_REACH + CLOSE_STEP, CLOSE_STEP)
    kept = np.array([kept_share(before, after, yaw, CLOSELY.growth) for yaw in yaws])
    best = int(np.lexsort((np.abs(yaws - near), -kept.round(9)))[0])
    about = slice(max(best - 3, 0), best + 4)
    bend, slope, _ = np.polyfit(yaws[about] - yaws[best], kept[about], 2)
    top = float(np.clip(-slope / (2.0 * bend), -CLOSE_STEP, CLOSE_STEP)) if bend < 0 else 0.0
    return float((yaws[best] + top + 180.0) % 360.0 - 180.0)


def organs_kept(earlier: Stand, later: Stand, yaw: float) -> float:
    """The share (0 to 1) of the organs' levers that keeps its direction from the stem.

    Organs are paired so that most is kept; one that is found far higher or lower counts less.
    """
    from scipy.optimize import linear_sum_assignment

    before, after = (Around.stem(stand.organs.centers) for stand in (earlier, later))
    turn = after.azimuth + np.radians(yaw) - before.azimuth[:, None]
    turn = (turn + np.pi) % (2.0 * np.pi) - np.pi
    kept = np.minimum(before.radius[:, None], after.radius)
    with np.errstate(over="ignore"):  # a plant of no height keeps what is level, and nothing else
        climb = (after.height - before.height[:, None]) / max(earlier.height, np.finfo(float).tiny)
        kept = kept * np.exp(-0.5 * ((turn / TURN_KEPT) ** 2 + climb**2))
    total = before.radius.sum()
    return float(kept[linear_sum_assignment(-kept)].sum() / total) if total > 0.0 else 1.0


def difference(yaw: float, other: float) -> float:
    """Degrees from `other` to `yaw`, the shorter way round."""
    return (yaw - other + 180.0) % 360.0 - 180.0


def _kept(earlier: Stand, later: Stand, yaws: NDArray[np.floating]) -> NDArray[np.float64]:
    """(n,) how much stays at each yaw: the mean share of the points and of the organs."""
    points = at_one_spacing(earlier.sample, later.sample, ALL_ROUND.points)
    before, after = (Around.stem(each) for each in points)
    return (
        np.array(
            [
                kept_share(before, after, yaw, ALL_ROUND.growth) + organs_kept(earlier, later, yaw)
                for yaw in yaws
            ]
        )
        / 2.0
    )
