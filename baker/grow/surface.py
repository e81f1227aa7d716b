"""From material coordinates to positions, areas and evenly spread samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.grow.part import NODES
from baker.grow.pose import Array, Body, Index, Pose, at_node

STRIPES = 12  # across every strip, for areas


@dataclass(frozen=True)
class Material:
    """Points of tissue, told apart for ever.

    part:   (N,) index of the part.
    along:  (N,) float64, 0 at the part's attachment to 1 at its tip.
    across: (N,) float64, -1 to 1, the midrib at 0; a tube closes where -1 meets 1.
    """

    part: Index
    along: Array
    across: Array

    def __len__(self) -> int:
        return len(self.part)


def positions(body: Body, pose: Pose, material: Material) -> Array:
    """Where tissue is, (N, 3) mm."""
    part, along, across = material.part, material.along, material.across
    spread = at_node(pose.spread, part, along)
    roll = at_node(pose.roll, part, along)
    # An arc of length 2 * spread and angle 2 * roll; np.sinc keeps the flat limit exact.
    sideways = spread * across * np.sinc(roll * across / np.pi)
    height = spread * roll * across**2 / 2 * np.sinc(roll * across / 2 / np.pi) ** 2
    height -= np.where(body.tube[part], spread / np.pi, 0)
    height += spread * body.fold[part] * (np.sqrt(across**2 + 0.02) - np.sqrt(0.02))
    height += at_node(pose.ruffle, part, along) * _ripple(body, material)
    frame = at_node(pose.frame, part, along)
    return (
        at_node(pose.axis, part, along)
        + sideways[:, None] * frame[:, 1]
        + height[:, None] * frame[:, 2]
    )


def _ripple(body: Body, material: Material) -> Array:
    """Waves along the two margins, out of step with one another, none at base and tip."""
    side = np.where(material.across > 0, 1.7, 0.0)
    turns = 2 * np.pi * body.waves[material.part] * material.along
    wave = np.sin(turns + body.phase[material.part] + side)
    return wave * material.across**2 * np.sin(np.pi * material.along) ** 0.7


def normals(body: Body, pose: Pose, material: Material) -> Array:
    """Unit normals (N, 3): out of a tube, from the upper side of a strip."""
    roll = at_node(pose.roll, material.part, material.along) * material.across
    fold = body.fold[material.part] * np.clip(material.across / 0.2, -1, 1)
    angle = roll + np.arctan(fold)
    frame = at_node(pose.frame, material.part, material.along)
    normal = np.cos(angle)[:, None] * frame[:, 2] - np.sin(angle)[:, None] * frame[:, 1]
    return np.where(body.tube[material.part], -1.0, 1.0)[:, None] * normal


def areas(body: Body, pose: Pose) -> Array:
    """Surface of every cell between the nodes, (P, NODES - 1, STRIPES) mm²."""
    count = len(body.parts)
    part, along, across = np.meshgrid(
        np.arange(count),
        np.linspace(0, 1, NODES),
        np.linspace(-1, 1, STRIPES + 1),
        indexing="ij",
    )
    material = Material(part.ravel(), along.ravel(), across.ravel())
    grid = positions(body, pose, material).reshape(count, NODES, STRIPES + 1, 3)
    one = grid[:, 1:, 1:] - grid[:, :-1, :-1]
    other = grid[:, 1:, :-1] - grid[:, :-1, 1:]
    return np.linalg.norm(np.cross(one, other), axis=-1) / 2


def sample(area: Array, count: int, rng: np.random.Generator) -> Material:
    """Draw exactly `count` points evenly by area, in random order.

    Each part gets its share (largest remainder), spread over it by the R2 sequence (Roberts 2018,
    "The unreasonable effectiveness of quasirandom sequences"), shifted and shaken at random: as
    even as a scanner's points, and without any correspondence between two calls.
    """
    per_row = area.sum(2)
    per_part = per_row.sum(1)
    share = count * per_part / per_part.sum()
    number = np.floor(share).astype(np.intp)
    rest = np.argsort(number - share, kind="stable")[: count - number.sum()]
    number[rest] += 1

    part = np.repeat(np.arange(len(number)), number)
    rank = np.arange(count) - np.repeat(np.cumsum(number) - number, number)
    shift = rng.random((len(number), 2))
    plastic = 1.32471795724474602596
    even = shift[part] + rank[:, None] / np.array([plastic, plastic**2])
    even += rng.uniform(-0.35, 0.35, (count, 2)) / np.sqrt(number[part])[:, None]
    even %= 1.0

    rows = np.concatenate([[0.0], np.cumsum(per_row)])
    start = rows[part * (NODES - 1)]
    target = start + even[:, 0] * per_part[part]
    row = np.searchsorted(rows, target, side="right") - 1
    row = np.clip(row, part * (NODES - 1), (part + 1) * (NODES - 1) - 1)
    within = np.clip((target - rows[row]) / np.maximum(per_row.ravel()[row], 1e-300), 0, 1)
    along = (row % (NODES - 1) + within) / (NODES - 1)

    stripes = np.cumsum(area.reshape(-1, STRIPES)[row], axis=1)
    goal = even[:, 1] * stripes[:, -1]
    stripe = np.minimum((stripes < goal[:, None]).sum(1), STRIPES - 1)
    each = np.arange(count)
    above = stripes[each, stripe]
    size = np.maximum(area.reshape(-1, STRIPES)[row, stripe], 1e-300)
    across = -1 + 2 * (stripe + np.clip(1 - (above - goal) / size, 0, 1)) / STRIPES

    order = rng.permutation(count)
    return Material(part[order], along[order], across[order])


__all__ = ["Material", "NDArray", "areas", "normals", "positions", "sample"]
