"""What passes between the steps of reading one scan."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Columns:
    """All numeric fields of one file, as they stand in it.

    values:  field name as written in the file -> (N,) numbers of any dtype, all the same length.
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
    """

    points: NDArray
    labels: NDArray[np.int64] | None = None
    colors: NDArray[np.uint8] | None = None
    notes: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.points)

    def take(self, chosen: NDArray) -> Cloud:
        """The points at the indices (or where the mask) `chosen`, with their labels and colours."""
        return replace(
            self,
            points=self.points[chosen],
            labels=None if self.labels is None else self.labels[chosen],
            colors=None if self.colors is None else self.colors[chosen],
        )

    def noting(self, sentence: str) -> Cloud:
        return replace(self, notes=(*self.notes, sentence))
