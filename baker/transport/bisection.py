"""Recursive bisection: cut a cloud into even blocks, and carry plans between blocks to points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from baker.transport.problem import Edges, Indices, Masses, Points


def order(
    points: Points, depth: int, seed: int, like: Indices | None = None
) -> tuple[Indices, Indices]:
    """Indices of the points along `depth` levels of halving, and the axis of each cut.

    Every part is cut across its longest extent, in a frame turned at random by the seed; or, with
    the axes that another cloud was cut along, `like` that one.
    """
    from baker.transport.space_partition import halve

    axes = np.zeros(2**depth, np.int64) if like is None else like
    return halve(points @ _turn(seed), depth, axes, like is not None), axes


@cache
def _turn(seed: int) -> NDArray[np.float64]:
    """(3, 3) a random rotation or reflection."""
    return np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]


@dataclass(frozen=True)
class Blocks:
    """A cloud cut into compact blocks that hold equally many points, to within one.

    order: (n,) indices of the points, block after block.
    first: (blocks,) where in `order` each block begins.
    """

    order: Indices
    first: Indices

    def __len__(self) -> int:
        return len(self.first)

    def masses(self, masses: Masses) -> Masses:
        return np.add.reduceat(masses[self.order], self.first)

    def centres(self, points: Points) -> NDArray[np.float64]:
        sizes = np.diff(self.first, append=len(self.order))
        return np.add.reduceat(points[self.order], self.first) / sizes[:, None]


def cut(points: Points, count: int, seed: int) -> Blocks:
    """`count` blocks; another seed cuts elsewhere."""
    n = len(points)
    count = min(count, n)
    depth = max(1, int(count - 1).bit_length())
    return Blocks(order(points, depth, seed)[0], np.arange(count) * n // count)


def expand(
    rows: Blocks, columns: Blocks, supply: Masses, demand: Masses, edges: Edges, mass: Masses
) -> tuple[Edges, Masses]:
    """A feasible plan between points from a feasible plan between blocks.

    Along each pair of blocks the north-west corner rule hands out the mass in the blocks' order.
    With one block a side this is the bisection coupling (BSP-OT, Genest et al. 2025, there for
    equal sizes). Whole masses, so feasible for any sizes; at most n + m pairs and the blocks' own.
    """
    from baker.transport.space_partition import hand_out

    by_row = np.argsort(edges[0] * len(columns) + edges[1], kind="stable")
    one, other, handed = hand_out(
        edges[1][by_row], mass[by_row], supply[rows.order], demand[columns.order], columns.first
    )
    return (rows.order[one], columns.order[other]), handed


def couple(
    start: Points, end: Points, supply: Masses, demand: Masses, seed: int
) -> tuple[Edges, Masses]:
    """A feasible plan that pairs what lies at the same place of both bisections."""
    depth = max(1, (min(len(start), len(end)) - 1).bit_length())
    columns, axes = order(end, depth, seed)
    rows, _ = order(start, depth, seed, like=axes)
    whole = np.zeros(1, np.int64)
    return expand(
        Blocks(rows, whole), Blocks(columns, whole),
        supply, demand, (whole, whole), np.array([supply.sum()]),
    )  # fmt: skip
