"""The motion of one organ in an interval: its deformation, and its shape at mid-interval."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import interpolate
from baker.interpolation.deformation import register_nonrigid
from baker.interpolation.organ_shapes import OrganShape, common_nodes
from baker.interpolation.pose import starting_pose
from baker.interpolation.spine import (
    NODE_POSITIONS,
    Floats,
    Points,
    fit_spine,
    interpolate_nodes,
    section_weights,
    unit,
)

# Range of the unevenness of a deformation. Below it, an organ turns evenly in time; above it, it
# turns as it grows (docs/method.md, "Motion of organs").
UNEVENNESS_RANGE = (0.04, 0.1)
UNEVENNESS_OF_GROWTH = 0.08  # that any growth has, for each factor e
FIRST_NEIGHBOR, LAST_NEIGHBOR, NEIGHBOR_STEP = 24, 72, 8  # to which the stretch is measured
MAX_LOG_STRETCH = 2.0  # to which outliers are clipped
POINTS_COMPARED = 100  # number of points of an organ at which the stretch is measured
NEIGHBORS = 4  # number of points of the sample from which other points are interpolated
MAX_MID_WIDENING = 1.25  # greatest factor on cross-sections at mid-interval
MIN_COSINE = -0.9  # between the directions of a piece of the spine in both scans


@dataclass(frozen=True)
class OrganMotion:
    """The motion of a sample of an organ's points."""

    sample: Points  # (n, 3) points in the first scan
    deformed: Points  # (n, 3) their positions in the second scan
    deviations: Points  # (n, 3) from the middles of their chords, at mid-interval
    is_reversed: bool = False  # whether the second scan was deformed onto the first

    def registered(
        self, start: NDArray[np.floating], end: NDArray[np.floating]
    ) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
        """The points of the organ in both scans, after those of one are deformed onto the other."""
        shift = self.deformed - self.sample
        if self.is_reversed:
            return start, end - interpolate(end, self.deformed, shift, NEIGHBORS)
        return start + interpolate(start, self.sample, shift, NEIGHBORS), end

    def deviation(self, points: NDArray[np.floating]) -> Points:
        """(n, 3) deviation at mid-interval, from their chords, of movers that start at points."""
        return interpolate(points, self.sample, self.deviations, NEIGHBORS)


def fit_motion(source: OrganShape, target: OrganShape, grows_at_base: bool = True) -> OrganMotion:
    """Register an organ in two scans, and estimate its spine at mid-interval.

    The shorter organ is deformed onto the longer one, so that the motion is the same in reverse.
    grows_at_base: whether new tissue is at the base, so that an organ may turn as it grows.
    """
    if source.length > target.length:
        back = fit_motion(target, source, grows_at_base)
        return replace(back, sample=back.deformed, deformed=back.sample, is_reversed=True)
    landmarks = common_nodes(source, target)
    moved = starting_pose(source, target, landmarks)
    deformed = register_nonrigid(moved, target.points, landmarks)
    along = source.spine.along
    start, end = fit_spine(source.points, along).nodes, fit_spine(deformed, along).nodes
    offsets = source.points - interpolate_nodes(start, along)
    uneven = unevenness(source.points, deformed) if grows_at_base else 0.0
    share = growth_share(start, end, uneven)
    bend = interpolate_nodes(mid_spine(start, end, share) - 0.5 * (start + end), along)
    deviations = bend + _widening(offsets, deformed - interpolate_nodes(end, along), along)
    return OrganMotion(source.points, deformed, deviations)


def _widening(before: Points, after: Points, along: Floats) -> Points:
    """(n, 3) deviations of offsets from the spine, so that cross-sections keep their mean size.

    A blade that rolls would be too narrow at mid-interval otherwise.
    """
    middle = 0.5 * (before + after)
    weights = section_weights(along, NODE_POSITIONS)
    sizes = [np.sqrt(weights @ (side**2).sum(axis=1)) for side in (before, after, middle)]
    factor = 0.5 * (sizes[0] + sizes[1]) / np.maximum(sizes[2], 1e-30)
    factor = np.minimum(factor, MAX_MID_WIDENING)
    return (interpolate_nodes(factor, along)[:, None] - 1.0) * middle


def mid_spine(start: Points, end: Points, share: float) -> Points:
    """(NODES, 3) nodes of a spine at mid-interval.

    It is integrated from the attachment, so that it keeps its length where chords would cut across
    a bend. The length of each segment is the squared mean of the square roots of its lengths: young
    tissue grows by a factor, older tissue by an amount, so more growth means less at mid-interval.

    share: by how much the longer of both segments counts more for the direction. With 0, a segment
    has made half of its turn; with 1, new tissue lies in the new direction.
    """
    segments = np.stack([np.diff(start, axis=0), np.diff(end, axis=0)])
    lengths = np.linalg.norm(segments, axis=2, keepdims=True)
    directions = unit(segments)
    steps = np.sqrt(lengths).mean(axis=0) ** 2 * unit((lengths**share * directions).sum(axis=0))
    # Between opposite directions, the smallest rotation is not unique: the chord is used.
    cosine = directions.prod(axis=0).sum(axis=1, keepdims=True)
    steps = np.where(cosine < MIN_COSINE, segments.mean(axis=0), steps)
    return np.cumsum(np.concatenate([0.5 * (start[:1] + end[:1]), steps]), axis=0)


def growth_share(start: Points, end: Points, uneven: float) -> float:
    """The `share` of `mid_spine`: 0 if an organ turns evenly in time, 1 if it turns as it grows.

    The more an organ grows, the less even its deformation is. start, end: (NODES, 3) nodes in both
    scans. uneven: as `unevenness` returns it.
    """
    lengths = [np.linalg.norm(np.diff(nodes, axis=0), axis=1).sum() for nodes in (start, end)]
    growth = abs(float(np.diff(np.log(np.maximum(lengths, 1e-30)))[0]))
    return float(np.interp(uneven - UNEVENNESS_OF_GROWTH * growth, UNEVENNESS_RANGE, (0.0, 1.0)))


def unevenness(sample: Points, deformed: Points) -> float:
    """Standard deviation of the logarithm of the stretch between (n, 3) points and neighbours."""
    from scipy.spatial import cKDTree

    chosen = np.arange(0, len(sample), max(len(sample) // POINTS_COMPARED, 1))
    nearest = cKDTree(sample).query(sample[chosen], k=min(LAST_NEIGHBOR, len(sample)))[1]
    nearest = nearest[:, FIRST_NEIGHBOR::NEIGHBOR_STEP]
    before = np.linalg.norm(sample[chosen, None] - sample[nearest], axis=2)
    after = np.linalg.norm(deformed[chosen, None] - deformed[nearest], axis=2)
    stretch = np.log(after[before > 0] / before[before > 0] + 1e-6)
    stretch = np.clip(stretch, -MAX_LOG_STRETCH, MAX_LOG_STRETCH)
    return float(stretch.std()) if stretch.size else UNEVENNESS_RANGE[1]
