"""How one organ moves through an interval: where each point goes, and by which way."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.interpolation.deformation import register_nonrigid, spine_deformation
from baker.interpolation.organ_shape import OrganShape
from baker.interpolation.spine import Points, at_levels, fit_spine, unit

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

EVEN, UNEVEN = 0.04, 0.1  # unevenness of a warp up to which an organ turns, from which it grows
STEADY, WANDERING = 0.1, 0.3  # how far a hinge moves, in organ lengths: likewise
NO_SIGN = (0.08, 0.2)  # of either, that goes with growth by the factor e
TORN = 0.4  # unevenness of a warp that is not to be trusted
NEAR, FAR, STEP = 24, 72, 8  # neighbours whose distances tell how evenly a warp stretches
ASKED = 100  # points whose neighbours are asked


@dataclass(frozen=True)
class OrganMotion:
    """The motion of an organ, known at a sample of its points and at the nodes of its spine.

    sample: (n, 3) points of the start; along: (n,) their places along the spine, 0 to 1;
    warped: (n, 3) where they come to lie in the end's shape.
    start_nodes, half_nodes, end_nodes: (LEVELS, 3) the spine at the start, half way and the end.
    pace:   0 where the organ turns evenly in time, 1 where it turns as it grows.
    """

    sample: Points
    along: NDArray[np.float64]
    warped: Points
    start_nodes: Points
    half_nodes: Points
    end_nodes: Points
    pace: float

    def warp(self, points: NDArray[np.floating]) -> Points:
        """(n, 3) where points of the start's shape come to lie in the end's."""
        return points + self._nearby(points, self.warped - self.sample)

    def bow(self, points: NDArray[np.floating]) -> Points:
        """(n, 3) how far movers that start at these points are off their chord half way."""
        return at_levels(self.bows, self._nearby(points, self.along))

    def halfway(self, start: NDArray[np.floating], end: NDArray[np.floating]) -> Points:
        """(n, 3) where movers from `start` to `end` are in the organ's shape half way."""
        return 0.5 * (np.asarray(start, float) + end) + self.bow(start)

    @cached_property
    def bows(self) -> Points:
        """(LEVELS, 3) how far the spine's nodes are off their chord half way."""
        return self.half_nodes - 0.5 * (self.start_nodes + self.end_nodes)

    @cached_property
    def _tree(self) -> cKDTree:
        from scipy.spatial import cKDTree

        return cKDTree(self.sample)

    def _nearby(
        self, points: NDArray[np.floating], values: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Values of the sample, (n, ...), read between its points."""
        count = min(4, len(self.sample))
        away, near = self._tree.query(points, k=count)
        away, near = away.reshape(len(points), count), near.reshape(len(points), count)
        weight = 1.0 / np.maximum(away, 1e-9 * (away.max() + 1e-30))
        weight /= weight.sum(axis=1, keepdims=True)
        return np.einsum("nk,nk...->n...", weight, values[near])


def fit_motion(start: OrganShape, end: OrganShape, least: float = 0.0) -> OrganMotion | None:
    """Bend the start's shape onto the end's, draw it close, and lay the spine half way.

    least: bows up to this length don't matter.

    None where the organ's bows don't matter, or where the warp tears it: it goes straight.
    """
    here, there = start.spine.nodes, end.spine.nodes
    if max(_largest(_bows(here, there, pace)) for pace in (0.0, 1.0)) < least:
        return None
    carried = spine_deformation(start.points, end.points, start.spine, end.spine)
    warped = register_nonrigid(carried, end.points)
    uneven = unevenness(start.points, warped)
    if uneven > TORN:
        return None
    motion = motion_of(start.points, start.spine.along, warped, uneven)
    return motion if _largest(motion.bows) >= least else None


def motion_of(
    sample: Points, along: NDArray[np.float64], warped: Points, uneven: float
) -> OrganMotion:
    """The motion that a warp of (n, 3) points at places (n,) along a spine is.

    uneven: the warp's `unevenness`.
    """
    here, there = fit_spine(sample, along).nodes, fit_spine(warped, along).nodes
    pace = growth_pace(here, there, uneven)
    return OrganMotion(sample, along, warped, here, half_way_spine(here, there, pace), there, pace)


def half_way_spine(start: Points, end: Points, pace: float) -> Points:
    """(LEVELS, 3) nodes of a spine half way from one shape to another.

    Every piece has a mean of its lengths, and they are laid one after the other from the base: so
    the spine keeps its length where chords would cut across the bend. It is the mean of their
    roots, squared: tissue grows by a factor while young, by an amount later on, so that half-way it
    is the shorter the more it grows. Which way a piece points is a question of pace. At 0 it has
    made half of its turn. At 1 the longer of both pieces counts more, as where tissue that is added
    lies in the new direction: just as chords would have it.
    """
    one, two = np.diff(start, axis=0), np.diff(end, axis=0)
    before = np.linalg.norm(one, axis=1, keepdims=True)
    after = np.linalg.norm(two, axis=1, keepdims=True)
    heading = before**pace * unit(one) + after**pace * unit(two)
    steps = (0.5 * (np.sqrt(before) + np.sqrt(after))) ** 2 * unit(heading)
    # Where a piece turns right round no way is shorter than another: the chord's is as good.
    turned = (unit(one) * unit(two)).sum(axis=1, keepdims=True) < -0.9
    steps = np.where(turned, 0.5 * (one + two), steps)
    first = 0.5 * (start[0] + end[0])
    return first + np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])


def growth_pace(start: Points, end: Points, uneven: float) -> float:
    """0 where an organ turns evenly in time, 1 where it turns as it grows, between where unsure.

    It turns as a body does where the warp stretches it evenly and the hinge stands still, for as
    much as it grows: what trebles is never stretched as evenly as what stays as long as it was.
    """
    before, after = max(_length(start), 1e-30), max(_length(end), 1e-30)
    growth = abs(float(np.log(after / before)))
    wander = float(np.linalg.norm(end[0] - start[0])) / max(before, after)
    signs = (
        (uneven - NO_SIGN[0] * growth - EVEN) / (UNEVEN - EVEN),
        (wander - NO_SIGN[1] * growth - STEADY) / (WANDERING - STEADY),
    )
    return float(np.clip(max(signs), 0.0, 1.0))


def unevenness(sample: Points, warped: Points) -> float:
    """Standard deviation of the logarithm of a warp's stretch between points near each other."""
    from scipy.spatial import cKDTree

    some = np.arange(0, len(sample), max(len(sample) // ASKED, 1))
    near = cKDTree(sample).query(sample[some], k=min(FAR, len(sample)))[1][:, NEAR::STEP]
    before = np.linalg.norm(sample[some, None] - sample[near], axis=2)
    after = np.linalg.norm(warped[some, None] - warped[near], axis=2)
    stretch = np.log(after[before > 0] / before[before > 0] + 1e-6)
    return float(np.clip(stretch, -2.0, 2.0).std()) if stretch.size else UNEVEN


def _length(nodes: Points) -> float:
    return float(np.linalg.norm(np.diff(nodes, axis=0), axis=1).sum())


def _bows(start: Points, end: Points, pace: float) -> Points:
    return half_way_spine(start, end, pace) - 0.5 * (start + end)


def _largest(vectors: Points) -> float:
    return float(np.linalg.norm(vectors, axis=1).max())
