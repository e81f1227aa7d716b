"""What passes between the steps of reading one scan, and the origin that a series shares."""

from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

MAX_DISTANCE_RATIO = 16  # scans further from zero than so many of their sizes get an own origin
MIN_COORDINATE = 1e-18  # nearer to the origin is zero: in 32 bits its square is nothing
MAX_SAMPLES = 20_000  # points of a scan by which its place is found
MAX_STEP_RATIO = 1e-5  # of a scan's size: with larger float32 steps it gets its own origin


@dataclass(frozen=True)
class Columns:
    """All fields of one file, as they stand in it.

    values:  field name as written in the file -> (N,) numbers of any dtype, all the same length;
             or words, where it may be that of labels.
    notes:   what the reader had to decide, one sentence each.
    """

    values: dict[str, NDArray]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Cloud:
    """One scan on its way from the file to a `Scan`.

    points:  (N, 3), float64 world positions at first, float32 about the series' origin later.
    labels:  (N,) int64 or None.
    colors:  (N, 3) uint8 sRGB or None.
    notes:   one sentence for each thing found or dropped on the way.
    fields:  name -> (N,) numbers or words, that may be labels; which ones the series decides.
    scalars: name -> (N,) float32, what else is carried into the clip.
    """

    points: NDArray
    labels: NDArray[np.int64] | None = None
    colors: NDArray[np.uint8] | None = None
    notes: tuple[str, ...] = ()
    fields: dict[str, NDArray] = field(default_factory=dict)
    scalars: dict[str, NDArray[np.float32]] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.points)

    def take(self, chosen: NDArray) -> "Cloud":
        """The points at the indices (or where the mask) `chosen`, with their labels and colours."""
        labels = None if self.labels is None else self.labels[chosen]
        colors = None if self.colors is None else self.colors[chosen]
        fields = {name: values[chosen] for name, values in self.fields.items()}
        scalars = {name: values[chosen] for name, values in self.scalars.items()}
        return Cloud(self.points[chosen], labels, colors, self.notes, fields, scalars)

    def noting(self, sentence: str) -> Self:
        return replace(self, notes=(*self.notes, sentence))


def shared_origin(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """The (3,) origin of a series, by the (N, 3) world positions of its first scan.

    Zeros while float32 about the world's zero is exact enough (its step stays below 2e-6 of the
    plant); beyond that the lower corner of the box of 98 % of the points along each axis, as a
    scanner's zero returns don't count, rounded down to the power of ten below the box's size.
    """
    low, high = np.percentile(points, [1, 99], axis=0)
    size = float((high - low).max())
    if size == 0 or max(np.abs(low).max(), np.abs(high).max()) <= MAX_DISTANCE_RATIO * size:
        return np.zeros(3)
    digits = -int(np.floor(np.log10(size)))
    step = 10.0**-digits
    return np.round(np.floor(low / step) * step, max(digits, 0))


def own_origin(points: NDArray[np.float64], shared: NDArray[np.float64]) -> NDArray[np.float64]:
    """The (3,) origin of one scan: the series', unless its (N, 3) world positions are far from it.

    Then they are in another coordinate system, and float32 about its origin would lose them.
    """
    some = points[:: -(-len(points) // MAX_SAMPLES)] - shared
    low, high = np.percentile(some, [1, 99], axis=0)
    step = 2.0**-23 * max(np.abs(low).max(), np.abs(high).max())
    return shared_origin(points) if step > MAX_STEP_RATIO * (high - low).max() > 0 else shared


def relative_to(origin: NDArray[np.float64], cloud: Cloud) -> Cloud:
    """`cloud` with points in float32 about `origin`."""
    # Adding zero turns -0.0 into 0.0, so that equal points have equal bytes.
    exact = cloud.points - origin + 0.0
    local = np.where(np.abs(exact) < MIN_COORDINATE, 0.0, exact).astype(np.float32)
    return replace(cloud, points=local)
