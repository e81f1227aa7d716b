"""Find the pot that a plant grows in, where its wall shows all around.

The soil is then searched for within the wall, as any ground is.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import Points
from baker.scans.ground_plane import Ground, find_plane, outline_of

# docs/method.md, "Alignment". Radii are those of the wall.
SLICES = 0.03, 0.07, 0.12, 0.2, 0.3  # shares of the height, between which a wall is searched for
SECTORS, MIN_CLOSED = 32, 0.7  # number of sectors around a wall; least share of them with points
MIN_ROUNDNESS = 0.5  # least distance of these points from the middle, in greatest distances
MIN_HOLLOW = 0.8  # least median distance of all points of the wall from the middle, in radii
SOIL_RADIUS, POT_RADIUS = 0.8, 1.6  # around the middle, of the soil and of the whole pot, in radii
WALL_WIDTH = 0.2  # on both sides of the pot's outline, in radii
ROUGHNESS = 1.2  # thickness of all the soil, in thicknesses of its middle
MIN_SCORE = 0.7  # of the soil


@dataclass(frozen=True)
class Pot(Ground):
    """The soil in a pot, and the pot, with the outline that it has at the soil."""

    margin: float  # greatest distance of the wall from the outline
    rim: float  # height of the wall above the soil

    def holds(self, points: Points) -> NDArray[np.bool_]:
        """(N,) whether points lie in the soil, below it, or in the wall."""
        _, heights, inside = self.coordinates(points)
        held = (heights <= self.rim) & (np.abs(inside) <= self.margin)
        held[~held] = super().holds(points[~held])
        return held


def find_pot(sample: Points, frame: Points) -> Pot | None:
    """Find the pot of a plant of (N, 3) points, or None; frame: rotates up to +z."""
    rotated = sample @ frame.T
    flat, heights = rotated[:, :2], rotated[:, 2]
    bottom, top = np.quantile(heights, [0.002, 1.0])
    for low, high in pairwise([bottom + share * (top - bottom) for share in SLICES]):
        wall = flat[(low < heights) & (heights <= high)]
        if radius := _radius(wall):
            distances = np.linalg.norm(flat - wall.mean(axis=0), axis=1)
            distances[heights <= high] = np.inf
            soil = find_plane(sample[distances < SOIL_RADIUS * radius], frame)
            if soil and soil.score >= MIN_SCORE:
                return _pot_around(soil, sample[distances < POT_RADIUS * radius])
    return None


def _radius(wall: Points) -> float:
    """The radius of (N, 2) points of a wall; 0 if they are not on a closed, hollow curve."""
    if len(wall) < SECTORS:
        return 0.0
    x, y = (wall - wall.mean(axis=0)).T
    sectors = np.floor(np.arctan2(y, x) / (2 * np.pi) * SECTORS).astype(int)
    distances, farthest = np.hypot(x, y), np.zeros(SECTORS)
    np.maximum.at(farthest, sectors, distances)
    is_closed = np.mean(farthest > MIN_ROUNDNESS * farthest.max()) >= MIN_CLOSED
    radius = float(np.median(farthest))
    return radius if is_closed and np.median(distances) > MIN_HOLLOW * radius else 0.0


def _pot_around(soil: Ground, points: Points) -> Pot:
    """The pot around this soil; points: (N, 3), of the whole pot and of what is above it."""
    rotated, heights, _ = soil.coordinates(points)
    flat = rotated[:, :2]
    outline, _ = outline_of(flat[np.abs(heights) <= soil.thickness], 0.0)
    _, _, inside = replace(soil, outline=outline).coordinates(points)
    margin, thickness = WALL_WIDTH * float(inside.max()), ROUGHNESS * soil.thickness
    in_wall, rim, step = np.abs(inside) <= margin, thickness, margin / 2
    while _radius(flat[in_wall & (rim < heights) & (heights <= rim + step)]):
        rim += step
    return Pot(soil.frame, soil.height, thickness, outline, soil.score, margin, rim)
