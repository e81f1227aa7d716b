"""Positions, normals and areas of tissue by material coordinates, and even samples of it."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from grow.part import NODES
from grow.pose import Array, Body, Index, Pose, at_node

STRIPES = 10  # cells across every strip, for areas


@dataclass(frozen=True)
class Material:
    """Points of tissue, identified at all times by their material coordinates.

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
    """(N, 3) positions of tissue, mm."""
    part, along = material.part, material.along
    axis, frame, spread, roll, ruffle = (
        at_node(values, part, along)
        for values in (pose.axis, pose.frame, pose.spread, pose.roll, pose.ruffle)
    )
    section = Section(spread, roll, ruffle, body.tube[part], body.fold[part])
    turns = 2 * np.pi * body.waves[part] * along + body.phase[part]
    sideways, height = section.at(material.across, turns, along)
    return axis + sideways[:, None] * frame[:, 1] + height[:, None] * frame[:, 2]


class Section(NamedTuple):
    """Cross-sections of parts, in arrays of one shape; see `Pose` and `Part` for the fields."""

    spread: Array
    roll: Array
    ruffle: Array
    tube: NDArray[np.bool_]
    fold: Array

    def at(self, across: Array, turns: Array, along: Array) -> tuple[Array, Array]:
        """Offsets from the axis along the strip's width and its normal, mm.

        The section is an arc of length 2 * spread and angle 2 * roll, centred for a tube, plus the
        fold at the midrib and waves along the margins, which vanish at base and tip.
        """
        # np.sinc is exact for flat sections, too.
        sideways = self.spread * across * np.sinc(self.roll * across / np.pi)
        arc = self.roll * across**2 / 2 * np.sinc(self.roll * across / 2 / np.pi) ** 2
        valley = self.fold * (np.sqrt(across**2 + 0.02) - np.sqrt(0.02))
        height = self.spread * (arc + valley - self.tube / np.pi)
        wave = np.sin(turns + np.where(across > 0, 1.7, 0.0)) * across**2
        return sideways, height + self.ruffle * wave * np.sin(np.pi * along) ** 0.7


def normals(body: Body, pose: Pose, material: Material) -> Array:
    """(N, 3) unit normals: outward from a tube, on the upper side of a strip."""
    roll = at_node(pose.roll, material.part, material.along) * material.across
    fold = body.fold[material.part] * np.clip(material.across / 0.2, -1, 1)
    angle = roll + np.arctan(fold)
    frame = at_node(pose.frame, material.part, material.along)
    normal = np.cos(angle)[:, None] * frame[:, 2] - np.sin(angle)[:, None] * frame[:, 1]
    return np.where(body.tube[material.part], -1.0, 1.0)[:, None] * normal


def areas(body: Body, pose: Pose) -> Array:
    """(P, NODES - 1, STRIPES) areas of the cells between the nodes, mm²."""
    along = np.linspace(0, 1, NODES)[:, None]
    across = np.linspace(-1, 1, STRIPES + 1)
    fold, waves, phase = (v[:, None, None] for v in (body.fold, body.waves, body.phase))
    spread, roll, ruffle = (v[..., None] for v in (pose.spread, pose.roll, pose.ruffle))
    section = Section(spread, roll, ruffle, body.tube[:, None, None], fold)
    sideways, height = section.at(across, 2 * np.pi * waves * along + phase, along)
    grid = pose.axis[:, :, None] + sideways[..., None] * pose.frame[:, :, None, 1]
    grid += height[..., None] * pose.frame[:, :, None, 2]
    a = grid[:, 1:, 1:] - grid[:, :-1, :-1]  # the diagonals of the cells
    b = grid[:, 1:, :-1] - grid[:, :-1, 1:]
    # Equivalent to the norm of np.cross(a, b), which takes four times as long.
    x = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    y = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    z = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return np.sqrt(x * x + y * y + z * z) / 2


def sample(area: Array, count: int, rng: np.random.Generator) -> Material:
    """Draw exactly `count` points, uniformly by area, in random order.

    The numbers of points of the parts are rounded by largest remainder. On each part, points are
    spread by the R2 sequence (Roberts 2018, "The unreasonable effectiveness of quasirandom
    sequences") with a random shift and jitter, so that two calls are independent.
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
    quasirandom = shift[part] + rank[:, None] / np.array([plastic, plastic**2])
    quasirandom += rng.uniform(-0.35, 0.35, (count, 2)) / np.sqrt(number[part])[:, None]
    quasirandom %= 1.0

    rows = np.concatenate([[0.0], np.cumsum(per_row)])
    start = rows[part * (NODES - 1)]
    target = start + quasirandom[:, 0] * per_part[part]
    row = np.searchsorted(rows, target, side="right") - 1
    row = np.clip(row, part * (NODES - 1), (part + 1) * (NODES - 1) - 1)
    fraction = np.clip((target - rows[row]) / np.maximum(per_row.ravel()[row], 1e-300), 0, 1)
    along = (row % (NODES - 1) + fraction) / (NODES - 1)

    stripes = np.cumsum(area.reshape(-1, STRIPES)[row], axis=1)
    target_area = quasirandom[:, 1] * stripes[:, -1]
    stripe = np.minimum((stripes < target_area[:, None]).sum(1), STRIPES - 1)
    index = np.arange(count)
    cumulative = stripes[index, stripe]
    size = np.maximum(area.reshape(-1, STRIPES)[row, stripe], 1e-300)
    across = -1 + 2 * (stripe + np.clip(1 - (cumulative - target_area) / size, 0, 1)) / STRIPES

    order = rng.permutation(count)
    return Material(part[order], along[order], across[order])
