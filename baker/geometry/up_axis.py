"""Which way is up: heights along one of the six axis directions, without turning the cloud."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Vertical:
    """The growing direction as an axis (0, 1, 2) and a sign (+1, -1)."""

    axis: int
    sign: int

    @classmethod
    def named(cls, up: str) -> Self:
        """From "x", "y", "z", "-x", "-y" or "-z"."""
        return cls("xyz".index(up[-1]), -1 if up.startswith("-") else 1)

    def height(self, points: NDArray[np.floating]) -> NDArray[np.floating]:
        """(N,) height of (N, 3) points."""
        return self.sign * points[:, self.axis]

    def at_height(
        self, points: NDArray[np.floating], height: float | NDArray[np.floating]
    ) -> NDArray[np.floating]:
        """A copy of (N, 3) points, each moved straight up or down to `height`, or its (N,) own."""
        moved = points.copy()
        moved[:, self.axis] = self.sign * height
        return moved
