"""A seedling of tubes and flat blades, to be cut into organs; lengths in stem diameters."""

import numpy as np


def tube(start, end, diameter: float, density: float, rng: np.random.Generator) -> np.ndarray:
    """(N, 3) points on the surface of a tube, `density` a unit of area."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    axis = end - start
    length = np.linalg.norm(axis)
    side = np.cross(axis, [0.3, 0.5, 0.8])
    side /= np.linalg.norm(side)
    other = np.cross(axis / length, side)
    count = int(density * np.pi * diameter * length)
    turn, along = rng.random(count) * 2 * np.pi, rng.random(count)
    ring = np.cos(turn)[:, None] * side + np.sin(turn)[:, None] * other
    return start + along[:, None] * axis + 0.5 * diameter * ring


def blade(
    base, azimuth: float, length: float, width: float, density: float, rng: np.random.Generator
) -> np.ndarray:
    """(N, 3) points of a flat, level, elliptic blade that begins at `base`."""
    count = int(density * np.pi / 4 * length * width)
    radius, turn = np.sqrt(rng.random(count)), rng.random(count) * 2 * np.pi
    along = 0.5 * length * (1 + radius * np.cos(turn))
    across = 0.5 * width * radius * np.sin(turn)
    away = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    aside = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    return np.asarray(base) + along[:, None] * away + across[:, None] * aside


def seedling(
    blades: int = 3, size: float = 5.0, density: float = 30.0, seed: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """(N, 3) points and (N,) labels: 0 for the stem and its petioles, then the blades."""
    rng = np.random.default_rng(seed)
    parts = [tube([0, 0, 0], [0, 0, 2.5 + 2.5 * blades], 1.0, density, rng)]
    labels = [0]
    for leaf in range(1, blades + 1):
        azimuth, height = 2.1 * leaf, 2.0 + 2.5 * leaf
        away = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        start, end = away * 0.4 + [0, 0, height], away * 2.5 + [0, 0, height + 1.0]
        parts += [
            tube(start, end, 0.6, density, rng),
            blade(end, azimuth, size, 0.6 * size, density, rng),
        ]
        labels += [0, leaf]
    points = np.concatenate(parts) + rng.normal(0, 0.02, (sum(map(len, parts)), 3))
    return points, np.repeat(labels, [len(part) for part in parts])
