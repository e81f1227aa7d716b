"""Synthetic clips with any number of movers, for benchmarks of the player."""

from __future__ import annotations

import math
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.geometry.morton import morton_order
from gclip import Clip, Motion, ScanMark, Track
from gclip.schema import BLOCK, Box, Group, Interval

LEAVES = 14
ORGANS = LEAVES + 1  # with the stem
COLORS = ((120, 170, 60), (70, 140, 50), (160, 190, 80), (90, 160, 90))
BOX = Box((-0.385, -0.385, -0.01), (0.385, 0.385, 1.54))  # of all control points
BLOCKS_AT_ONCE = 2048  # whose movers stay in a processor's cache
CELLS = 16, 8  # of a block along and across the organ, with one mover in each


def growing(count: int, degree: int = 2) -> Clip:
    """A clip of one interval: a stem with leaves that grow.

    Movers are in the order of clips that were baked: in shuffled blocks of neighbours.

    Parameters
    ----------
    count : int
        Number of movers.
    degree : {1, 2, 3}
        Degree of their curves.
    """
    order = np.random.default_rng(0).permutation(-(-count // BLOCK))
    of_organ = -(-len(order) // ORGANS)
    columns = max(math.isqrt(of_organ), 1)
    rows = -(-of_organ // columns)
    cells = np.argwhere(np.ones((*CELLS, 1)))
    cell_along, cell_across, _ = cells[morton_order(cells)].T
    curve = tuple(np.empty((len(order), BLOCK, 3), np.uint16) for _ in range(degree + 1))
    tracks = np.empty((len(order), BLOCK), np.uint16)

    def fill(first: int) -> None:
        part = slice(first, first + BLOCKS_AT_ONCE)
        patch, organ = np.divmod(order[part, None], ORGANS)
        row, column = np.divmod(patch, columns)
        jitter = np.random.default_rng(first).random((2, len(patch), BLOCK), np.float32)
        along = (row + (cell_along + jitter[0]) / CELLS[0]) / rows
        across = (column + (cell_across + jitter[1]) / CELLS[1]) / columns - 0.5
        tracks[part] = organ
        shapes = _control_points(organ, along.astype(np.float32), across.astype(np.float32), degree)
        for packed, points in zip(curve, shapes, strict=True):
            packed[part] = np.rint((points - np.float32(BOX.low)) / np.float32(BOX.step))

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(fill, range(0, len(order), BLOCKS_AT_ONCE)))
    interval = Interval(
        start=0.0,
        end=1.0,
        degree=degree,
        groups=(Group(0, count, Motion.MOVE),),
        box=BOX,
        curve=tuple(points.reshape(-1, 3)[:count] for points in curve),
        tracks=tracks.ravel()[:count],
    )
    return Clip(
        scans=tuple(ScanMark(name, time, name, count) for name, time in (("a", 0.0), ("b", 1.0))),
        intervals=(interval,),
        track_table=tuple(Track(i, str(i), COLORS[i % len(COLORS)]) for i in range(ORGANS)),
        spacing=1.5 / np.sqrt(count),
    )


def static(count: int) -> Clip:
    """A clip of the same plant without motion: the ends of its straight curves are equal."""
    clip = growing(count)
    (interval,) = clip.intervals
    middle = np.empty_like(interval.curve[0])
    for first in range(0, count, BLOCK * BLOCKS_AT_ONCE):
        part = slice(first, first + BLOCK * BLOCKS_AT_ONCE)
        start, control, end = (points[part] for points in interval.curve)
        middle[part] = np.rint(0.25 * start + 0.5 * control + 0.25 * end)
    static_interval = replace(interval, degree=1, curve=(middle, middle))
    return replace(clip, intervals=(static_interval,))


def _control_points(
    organ: NDArray, along: NDArray, across: NDArray, degree: int
) -> tuple[NDArray, ...]:
    """The control points of movers' curves, (B, BLOCK, 3) each; parameters: see `_shape`."""
    taper = np.abs(np.sin(np.pi * (0.05 + 0.95 * along))) ** 0.7  # width of a leaf at its points
    start, *between, end = (
        _shape(organ, along, across, taper, i / degree) for i in range(degree + 1)
    )
    if degree == 2:  # through the position at half the time
        between = [2.0 * between[0] - 0.5 * (start + end)]
    elif degree == 3:  # through the positions at one and two thirds of the time
        third, two_thirds = between
        between = [
            (-5.0 * start + 18.0 * third - 9.0 * two_thirds + 2.0 * end) / 6.0,
            (2.0 * start - 9.0 * third + 18.0 * two_thirds - 5.0 * end) / 6.0,
        ]
    return start, *between, end


def _shape(organ: NDArray, along: NDArray, across: NDArray, taper: NDArray, age: float) -> NDArray:
    """(B, BLOCK, 3) positions at an age from 0 to 1, on the stem for organ LEAVES, else on leaves.

    organ: (B, 1) numbers of organs. along, across: (B, BLOCK) float32 coordinates on them, from 0
    to 1 and from -0.5 to 0.5. taper: (B, BLOCK) factors on a leaf's width.
    """
    height, length, bend = 1.0 + 0.5 * age, 0.45 + 0.25 * age, 1.2 + 0.8 * age
    out = length * np.sin(bend * along + 0.3) / bend
    aside = (0.18 + 0.06 * age) * across * taper
    base = height * (0.1 + 0.85 * np.arange(ORGANS, dtype=np.float32) / LEAVES)
    rise = base[organ] + length * bend * (0.5 * along - 0.55 * along**2)
    yaw = 2.4 * np.arange(ORGANS, dtype=np.float32)
    cos, sin = np.cos(yaw)[organ], np.sin(yaw)[organ]
    leaf = [cos * out - sin * aside, sin * out + cos * aside, rise + 0.15 * across**2]
    points = np.stack(leaf, axis=-1)
    on_stem = organ[:, 0] == LEAVES
    angle = 2.0 * np.pi * across[on_stem]
    stem = [0.03 * np.cos(angle), 0.03 * np.sin(angle), height * along[on_stem]]
    points[on_stem] = np.stack(stem, axis=-1)
    return points
