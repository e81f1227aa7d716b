"""How one organ moves through an interval: its deformation, and its spine at mid-interval."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from baker.interpolation.deformation import register_nonrigid, spine_deformation
from baker.interpolation.organ_shapes import OrganShape
from baker.interpolation.spine import Points, at_levels, fit_spine, unit

# Unevenness of a deformation, and movement of the attachment point in organ lengths, up to which an
# organ turns evenly in time and from which on it turns as it grows (docs/method.md, "Motion").
UNEVENNESS_RANGE = (0.04, 0.1)
HINGE_RANGE = (0.1, 0.3)
UNEVENNESS_OF_GROWTH, HINGE_OF_GROWTH = 0.08, 0.2  # of what grows by the factor e, besides
FIRST_NEIGHBOR, LAST_NEIGHBOR, NEIGHBOR_STEP = 24, 72, 8  # whose distances show the stretch
POINTS_COMPARED = 100


@dataclass(frozen=True)
class OrganMotion:
    """The motion of an organ, known at a sample of its points and at the nodes of its spine."""

    sample: Points  # (n, 3), of the first scan
    along: NDArray[np.float64]  # (n,), their places along the spine, 0 to 1
    deformed: Points  # (n, 3), where they come to lie in the second scan
    deviations: Points  # (LEVELS, 3), at mid-interval, of the spine's nodes from their chords
    is_reversed: bool = False  # the second scan's organ was deformed onto the first scan's

    def registered(
        self, start: NDArray[np.floating], end: NDArray[np.floating]
    ) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
        """The organ's points in both scans, those of one deformed onto the other."""
        shift = self.deformed - self.sample
        if self.is_reversed:
            return start, end - _interpolated(end, self.deformed, shift)
        return start + _interpolated(start, self.sample, shift), end

    def deviation(self, points: NDArray[np.floating]) -> Points:
        """(n, 3) deviation at mid-interval of movers from these points from their chords."""
        return at_levels(self.deviations, _interpolated(points, self.sample, self.along))


def _interpolated(
    points: NDArray[np.floating], sample: Points, values: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Values of the sample, (n, ...), at other points, weighted by inverse distance."""
    from scipy.spatial import cKDTree

    distances, near = cKDTree(sample).query(points, k=[*range(1, min(4, len(sample)) + 1)])
    weights = 1.0 / np.maximum(distances, 1e-9 * (distances.max() + 1e-30))
    weights /= weights.sum(axis=1, keepdims=True)
    return np.einsum("nk,nk...->n...", weights, values[near])


def fit_motion(source: OrganShape, target: OrganShape) -> OrganMotion:
    """Deform an organ of the first scan onto that of the second, and place its spine in between.

    The shorter of both is deformed, so that backwards the motion is the same.
    """
    if source.length > target.length:
        back = fit_motion(target, source)
        return replace(back, sample=back.deformed, deformed=back.sample, is_reversed=True)
    children = source.nodes.keys() & target.nodes.keys()
    nodes = [
        np.array([shape.nodes[c] for c in sorted(children)], int) for shape in (source, target)
    ]
    landmarks = nodes[0], nodes[1]
    clouds = source.points, target.points
    carried = spine_deformation(*clouds, source.spine, target.spine, landmarks)
    deformed = register_nonrigid(carried, target.points, landmarks)
    along = source.spine.along
    start, end = fit_spine(source.points, along).nodes, fit_spine(deformed, along).nodes
    share = growth_share(start, end, unevenness(source.points, deformed))
    deviations = mid_spine(start, end, share) - 0.5 * (start + end)
    return OrganMotion(source.points, along, deformed, deviations)


def mid_spine(start: Points, end: Points, share: float) -> Points:
    """(LEVELS, 3) nodes of a spine at mid-interval.

    Each piece has a mean of its lengths, and they are joined from the attachment on: so the spine
    keeps its length where chords would cut across the bend. It is the squared mean of their roots:
    tissue grows by a factor while young and by an amount later on, so that at mid-interval it is
    the shorter the more it grows.

    share: 0 where a piece has made half of its turn; 1 where the longer of both pieces counts more,
    as where tissue that is added lies in the new direction.
    """
    pieces = np.diff(start, axis=0), np.diff(end, axis=0)
    lengths = [np.linalg.norm(piece, axis=1, keepdims=True) for piece in pieces]
    direction = sum(
        length**share * unit(piece) for length, piece in zip(lengths, pieces, strict=True)
    )
    steps = (0.5 * (np.sqrt(lengths[0]) + np.sqrt(lengths[1]))) ** 2 * unit(np.asarray(direction))
    # Where a piece turns right round no rotation is the smallest: the chord is as good.
    cosine = (unit(pieces[0]) * unit(pieces[1])).sum(axis=1, keepdims=True)
    steps = np.where(cosine < -0.9, 0.5 * (pieces[0] + pieces[1]), steps)
    first = 0.5 * (start[0] + end[0])
    return first + np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])


def growth_share(start: Points, end: Points, uneven: float) -> float:
    """0 where an organ turns evenly in time, 1 where it turns as it grows, between where unsure.

    It turns evenly where its deformation is even and its attachment point stands still, for as much
    as it grows: what trebles is never stretched as evenly as what keeps its length.
    """
    lengths = [np.linalg.norm(np.diff(nodes, axis=0), axis=1).sum() for nodes in (start, end)]
    before, after = np.maximum(lengths, 1e-30)
    growth = abs(float(np.log(after / before)))
    hinge = float(np.linalg.norm(end[0] - start[0])) / max(before, after)
    return max(
        _ramp(uneven - UNEVENNESS_OF_GROWTH * growth, *UNEVENNESS_RANGE),
        _ramp(hinge - HINGE_OF_GROWTH * growth, *HINGE_RANGE),
    )


def unevenness(sample: Points, deformed: Points) -> float:
    """Standard deviation of the logarithm of the stretch between neighbouring points, (n, 3)."""
    from scipy.spatial import cKDTree

    some = np.arange(0, len(sample), max(len(sample) // POINTS_COMPARED, 1))
    near = cKDTree(sample).query(sample[some], k=min(LAST_NEIGHBOR, len(sample)))[1]
    near = near[:, FIRST_NEIGHBOR::NEIGHBOR_STEP]
    before = np.linalg.norm(sample[some, None] - sample[near], axis=2)
    after = np.linalg.norm(deformed[some, None] - deformed[near], axis=2)
    stretch = np.log(after[before > 0] / before[before > 0] + 1e-6)
    return float(np.clip(stretch, -2.0, 2.0).std()) if stretch.size else UNEVENNESS_RANGE[1]


def _ramp(value: float, zero: float, one: float) -> float:
    """Rise from 0 at `zero` to 1 at `one`."""
    return float(np.clip((value - zero) / (one - zero), 0.0, 1.0))
