"""Heights along one of the six axis directions, without rotating the points."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Vertical:
    """The direction of growth as an axis (0, 1, 2) and a sign (+1, -1)."""

    axis: int
    sign: int

    @classmethod
    def named(cls, up: str) -> Self:
        """Make the direction that is called "x", "y", "z", "-x", "-y" or "-z"."""
        return cls("xyz".index(up[-1]), -1 if up.startswith("-") else 1)

    @property
    def to_z(self) -> NDArray[np.float64]:
        """(3, 3) rotation from this direction to +z, the identity for z up."""
        signs = np.array([[1], [self.sign], [self.sign]])
        return signs * np.roll(np.eye(3), -1 - self.axis, axis=0)

    def height(self, points: NDArray[np.floating]) -> NDArray[np.floating]:
        """(N,) height of (N, 3) points."""
        return self.sign * points[:, self.axis]

    def at_height(
        self, points: NDArray[np.floating], height: float | NDArray[np.floating]
    ) -> NDArray[np.floating]:
        """A copy of (N, 3) points, moved vertically to one height or to (N,) heights."""
        moved = points.copy()
        moved[:, self.axis] = self.sign * height
        return moved
