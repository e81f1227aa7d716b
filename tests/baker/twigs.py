"""Twigs with leaves whose every point is known, and a plain blade."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Twig:
    """points: (n, 3); leaf: (n,) the number of the leaf of each, -1 on the stalk."""

    points: np.ndarray
    leaf: np.ndarray

    @property
    def foot(self) -> int:
        return int(np.argmin(np.linalg.norm(self.points, axis=1)))


def blade(rng: np.random.Generator, count: int, length: float, width: float) -> np.ndarray:
    """(count, 3) points of a flat ellipse along x from the origin on, as even as a scanner's."""
    turns = np.arange(count) * (np.sqrt(5) - 1) / 2 + rng.random()  # Vogel's sunflower
    angle = 2 * np.pi * turns + rng.normal(0, 0.2, count)
    radius = np.sqrt((np.arange(count) + rng.random(count)) / count)
    along = length / 2 * (1 + radius * np.cos(angle))
    return np.stack([along, width / 2 * radius * np.sin(angle), np.zeros(count)], axis=1)


def twig(
    leaves: int, seed: int = 0, stretch: float = 1.0, swell: float = 1.0, density: int = 1
) -> Twig:
    """A stalk along z, `leaves` on it in turn, the first of them always at the same share.

    stretch: how far the stalk has grown; swell: how far the leaves have; density: how many times as
    many points as usual.
    """
    rng = np.random.default_rng(seed)
    height = 3.0 * (leaves + 1) * stretch
    stalk = np.zeros((round(12 * density * height), 3))
    stalk[:, 2] = np.sort(rng.uniform(0, height, len(stalk)))
    parts, numbers = [stalk], [np.full(len(stalk), -1)]
    for leaf in range(leaves):
        flat = blade(rng, 40 * density, 5.0 * swell, 2.5 * swell)
        turn = 2.4 * leaf
        rotation = np.array(
            [[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]]
        )
        parts.append(flat @ rotation.T + [0, 0, 3.0 * (leaf + 1) * stretch])
        numbers.append(np.full(len(flat), leaf))
    points = np.concatenate(parts) + rng.normal(0, 0.02, (sum(map(len, parts)), 3))
    return Twig(points, np.concatenate(numbers))
