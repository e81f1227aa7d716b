"""Which part of a picture something takes up, so that the rest needs no work."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from player.view.camera import Camera


@dataclass(frozen=True)
class Region:
    """A rectangle of whole texels: [left, right) × [bottom, top); empty where they meet."""

    left: int
    bottom: int
    right: int
    top: int

    @property
    def rectangle(self) -> tuple[int, int, int, int]:
        """Left, bottom, width and height, as OpenGL's scissor has it."""
        return self.left, self.bottom, self.right - self.left, self.top - self.bottom

    def joined(self, other: Region) -> Region:
        """The smallest region that holds both; an empty one adds nothing."""
        if other.right <= other.left or other.top <= other.bottom:
            return self
        if self.right <= self.left or self.top <= self.bottom:
            return other
        return Region(
            min(self.left, other.left),
            min(self.bottom, other.bottom),
            max(self.right, other.right),
            max(self.top, other.top),
        )

    def grown(self, margin: int, size: tuple[int, int]) -> Region:
        """By some texels all around, within a picture of `size`."""
        return self.scaled(size, 1, margin)

    def scaled(self, size: tuple[int, int], share: int, margin: int = 0) -> Region:
        """In a picture of `size` texels, each as large as `share` × `share` of these."""
        return Region(
            max(self.left // share - margin, 0),
            max(self.bottom // share - margin, 0),
            min(-(-self.right // share) + margin, size[0]),
            min(-(-self.top // share) + margin, size[1]),
        )


def whole(size: tuple[int, int]) -> Region:
    return Region(0, 0, *size)


def corners(low: NDArray, high: NDArray) -> NDArray[np.float64]:
    """(8, 3) corners of a box."""
    return np.array(list(product(*zip(low, high, strict=True))), np.float64)


def seen(
    points: NDArray, to_clip: NDArray, size: tuple[int, int], near: float, margin: float
) -> Region:
    """Where the convex hull of some points is in the picture.

    points:  (N, 3).
    to_clip: (4, 4) to OpenGL's clip coordinates.
    size:    (width, height) of the picture.
    near:    distance from the eye below which projecting says nothing: all of the picture then.
    margin:  texels that are added all around.
    """
    clip = np.column_stack([points, np.ones(len(points))]) @ to_clip.T
    if len(points) == 0 or clip[:, 3].min() < near:
        return whole(size)
    at = 0.5 * clip[:, :2] / clip[:, 3:] + 0.5
    return spanned(at.min(axis=0), at.max(axis=0), size, margin)


def spanned(low: NDArray, high: NDArray, size: tuple[int, int], margin: float) -> Region:
    """From `low` to `high`, in shares of the picture's width and height, and some texels more."""
    left, bottom = np.clip(np.floor(low * size - margin), 0, size).astype(int).tolist()
    right, top = np.clip(np.ceil(high * size + margin), 0, size).astype(int).tolist()
    return Region(left, bottom, right, top)


def half_field(camera: Camera, aspect: float) -> tuple[float, float]:
    """Tangents of half the angles that a picture of `aspect` shows, across and up."""
    slope = math.tan(camera.field_of_view / 2)
    return slope * aspect, slope
