"""A plant with a stem and leaves all round, that grows, and whose pose is known."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

LEAVES = (20.0, 110.0, 170.0, 300.0)  # azimuths in degrees; no turn maps them onto one another


def _plant(day: float, turned: dict[int, float] | None = None) -> np.ndarray:
    """(N, 3) float64 points, z up, the stem's base at the origin; a leaf's number may be turned."""
    rng = np.random.default_rng(int(10 * day) + 1)
    height = 40.0 + 6.0 * day
    around = rng.uniform(0.0, 2.0 * np.pi, 900)
    stem = np.column_stack([np.cos(around), np.sin(around), rng.uniform(0.0, height, 900)])
    parts = [stem]
    for number, azimuth in enumerate(LEAVES):
        length = (10.0 + 5.0 * number) * (1.0 + 0.15 * day)
        along, across = rng.random(700), rng.uniform(-0.5, 0.5, 700)
        out = 1.0 + length * along
        width = 0.4 * length * np.sin(np.pi * np.clip(along, 0.05, 0.95))
        up = (0.4 + 0.15 * number) * height + 0.8 * length * along * (1.0 - along)
        angle = np.radians(azimuth + (turned or {}).get(number, 0.0))
        x, y = out * np.cos(angle), out * np.sin(angle)
        x, y = x - across * width * np.sin(angle), y + across * width * np.cos(angle)
        parts.append(np.column_stack([x, y, up]))
    return np.concatenate(parts)


def _posed(points: np.ndarray, yaw: float, shift: tuple[float, float, float]) -> np.ndarray:
    """The points turned about z by degrees, then moved."""
    c, s = np.cos(np.radians(yaw)), np.sin(np.radians(yaw))
    return points @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) + shift


@pytest.fixture(scope="session")
def plant() -> Callable[..., np.ndarray]:
    return _plant


@pytest.fixture(scope="session")
def posed() -> Callable[..., np.ndarray]:
    return _posed


@pytest.fixture(scope="session")
def days() -> list[np.ndarray]:
    """Three scans of the plant, all in one frame."""
    return [_plant(day) for day in (0, 1, 2)]


@pytest.fixture(scope="session")
def scattered(days) -> list[np.ndarray]:
    """The same scans, each as it would lie when scanned alone."""
    yaws, shifts = (0.0, 140.0, -75.0), ((0, 0, 0), (30, -12, 5), (-8, 40, -22))
    return [_posed(*each) for each in zip(days, yaws, shifts, strict=True)]
