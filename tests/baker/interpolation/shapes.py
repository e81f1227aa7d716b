"""Growing shapes whose every point is known at every instant: the truth for motion's tests."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Shape = Callable[[Array, Array, float], Array]

STEPS = 200  # of an axis


def strip(
    along: Array,
    across: Array,
    *,
    length: float,
    width: float,
    rise: float,
    bend: float = 0.0,
    curl: float = 0.0,
    roll: float = 0.0,
    twist: float = 0.0,
) -> Array:
    """(n, 3) points of a strip whose axis leaves the origin.

    rise: of its base above the horizontal; bend: from base to tip downwards; curl: sideways;
    roll: half of its cross-section's arc; twist: about its axis; all in radians.
    """
    grid = np.linspace(0, 1, STEPS)
    pitch, yaw = rise - bend * grid**1.5, curl * grid**1.2
    zero = np.zeros(STEPS)
    ahead = np.stack(
        [np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw), np.sin(pitch)], axis=1
    )
    axis = np.concatenate([np.zeros((1, 3)), np.cumsum(ahead[:-1], axis=0)]) * length / (STEPS - 1)
    flat = np.stack([-np.sin(yaw), np.cos(yaw), zero], axis=1)
    up = np.cross(ahead, flat)
    turn = (twist * grid)[:, None]
    side, over = np.cos(turn) * flat + np.sin(turn) * up, np.cos(turn) * up - np.sin(turn) * flat
    breadth = width * np.sin(np.pi * (0.1 + 0.9 * along)) ** 0.7
    arc = max(roll, 1e-6)
    out, high = np.sin(arc * across) / arc, (1 - np.cos(arc * across)) / arc

    def read(values: Array) -> Array:
        return np.stack([np.interp(along, grid, column) for column in values.T], axis=1)

    return (
        read(axis) + (breadth * out)[:, None] * read(side) + (breadth * high)[:, None] * read(over)
    )


def leaf(along: Array, across: Array, u: float) -> Array:
    """Lengthens, bends over and opens."""
    return strip(
        along, across, length=70 + 20 * u, width=8 + 2 * u, rise=1.3 - 0.3 * u, bend=0.3 + 1.2 * u,
        roll=0.8 - 0.5 * u,
    )  # fmt: skip


def twisting(along: Array, across: Array, u: float) -> Array:
    """Twists about its own axis and sinks."""
    return strip(
        along, across, length=80 + 8 * u, width=9 + u, rise=0.9 - 0.9 * u, bend=0.5, roll=0.3,
        twist=0.8 * u,
    )  # fmt: skip


def rolling(along: Array, across: Array, u: float) -> Array:
    """Twists until its tip is upside down, and sinks."""
    return strip(
        along, across, length=80 + 8 * u, width=9 + u, rise=0.9 - 0.3 * u, bend=0.5, roll=0.3,
        twist=2.4 * u,
    )  # fmt: skip


def curling(along: Array, across: Array, u: float) -> Array:
    """Curls sideways and down."""
    return strip(
        along, across, length=80 + 10 * u, width=6, rise=0.6, bend=0.2 + u, curl=1.3 * u, roll=0.2
    )


def stem(along: Array, across: Array, u: float) -> Array:
    """A straight tube that lengthens."""
    angle, radius = np.pi * across, 3 + u
    return np.stack(
        [radius * np.cos(angle), radius * np.sin(angle), (100 + 40 * u) * along], axis=1
    )


def compound(along: Array, across: Array, u: float) -> Array:
    """A stalk that lengthens and sinks, and three leaflets: a quarter of `along` each."""
    part = np.minimum((4 * along).astype(int), 3)
    inside = np.clip(4 * along - part, 0, 1)
    pitch = 1.0 - 0.9 * u
    reach = 45 + 15 * u
    points = np.empty((len(along), 3))
    for index, (place, turn) in enumerate(((0.0, 0.0), (0.6, -1.1), (1.0, 0.0), (0.6, 1.1))):
        chosen = part == index
        length, width = (25 + 8 * u, 7 + 2 * u) if index else (reach, 1.0)
        own = strip(inside[chosen], across[chosen], length=length, width=width, rise=0.0)
        points[chosen] = own @ _about_z(turn).T + [place * reach, 0.0, 0.0]
    return points @ _about_y(pitch).T


SHAPES: dict[str, Shape] = {
    "leaf": leaf,
    "twisting": twisting,
    "rolling": rolling,
    "curling": curling,
    "stem": stem,
    "compound": compound,
}


def sample(shape: Shape, u: float, count: int, seed: int, noise: float = 0.0) -> Array:
    """(count, 3) an even sample of a shape, by area, with noise."""
    rng = np.random.default_rng(seed)
    step = 1e-3
    along, across = rng.uniform(0, 1 - step, 8 * count), rng.uniform(-1, 1 - step, 8 * count)
    here = shape(along, across, u)
    one, two = shape(along + step, across, u) - here, shape(along, across + step, u) - here
    area = np.linalg.norm(np.cross(one, two), axis=1)
    area = np.minimum(area, 5 * np.median(area))
    chosen = rng.choice(len(along), count, replace=False, p=area / area.sum())
    return here[chosen] + rng.normal(0, 1, (count, 3)) * noise


def _about_z(angle: float) -> Array:
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


def _about_y(pitch: float) -> Array:
    cos, sin = np.cos(pitch), np.sin(pitch)
    return np.array([[cos, 0.0, -sin], [0.0, 1.0, 0.0], [sin, 0.0, cos]])
