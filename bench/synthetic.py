"""Synthetic clips with any number of movers, for benchmarks of the player."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.interpolation.packing import Movers, pack_interval
from gclip import Clip, Motion, ScanMark, Track

LEAVES = 14
COLORS = ((120, 170, 60), (70, 140, 50), (160, 190, 80), (90, 160, 90))


def growing(count: int, degree: int = 2) -> Clip:
    """A clip of one interval: a stem with leaves that grow.

    Parameters
    ----------
    count : int
        Number of movers.
    degree : {1, 2, 3}
        Degree of their curves.
    """
    random = np.random.default_rng(0)
    organ = random.integers(0, LEAVES + 1, count)
    along, across = random.random(count), random.random(count) - 0.5
    ages = (0.0, 1 / 3, 1 / 2, 2 / 3, 1.0)
    start, third, half, two_thirds, end = (_shape(organ, along, across, age) for age in ages)
    controls: dict[int, tuple[NDArray, ...]] = {
        1: (),
        2: (2.0 * half - 0.5 * (start + end),),
        # The cubic curve through the positions at one and two thirds of the time.
        3: (
            (-5.0 * start + 18.0 * third - 9.0 * two_thirds + 2.0 * end) / 6.0,
            (2.0 * start - 9.0 * third + 18.0 * two_thirds - 5.0 * end) / 6.0,
        ),
    }
    movers = Movers(Motion.MOVE, (start, *controls[degree], end), organ)
    return Clip(
        scans=tuple(ScanMark(name, time, name, count) for name, time in (("a", 0.0), ("b", 1.0))),
        intervals=(pack_interval(0.0, 1.0, [movers], spacing=1.0),),
        track_table=tuple(Track(i, str(i), COLORS[i % len(COLORS)]) for i in range(LEAVES + 1)),
        spacing=1.5 / np.sqrt(count),
    )


def static(count: int) -> Clip:
    """A clip of the same plant without motion: the ends of its straight curves are equal."""
    clip = growing(count)
    (interval,) = clip.intervals
    points = sum(w * p for w, p in zip((0.25, 0.5, 0.25), interval.curve, strict=True))
    middle = np.round(points).astype(np.uint16)
    static_interval = replace(interval, degree=1, curve=(middle, middle))
    return replace(clip, intervals=(static_interval,))


def _shape(organ: NDArray, along: NDArray, across: NDArray, age: float) -> NDArray:
    """(N, 3) positions at an age from 0 to 1, on the stem for organ LEAVES, else on bent leaves.

    along, across: (N,) coordinates on the organ, from 0 to 1 and from -0.5 to 0.5.
    """
    height = 1.0 + 0.5 * age
    angle = 2.0 * np.pi * across
    stem = np.stack([0.03 * np.cos(angle), 0.03 * np.sin(angle), height * along], axis=1)
    length, bend = 0.45 + 0.25 * age, 1.2 + 0.8 * age
    out = length * np.sin(bend * along + 0.3) / bend
    aside = (0.18 + 0.06 * age) * across * np.sin(np.pi * (0.05 + 0.95 * along)) ** 0.7
    rise = height * (0.1 + 0.85 * organ / LEAVES) + length * bend * (0.5 * along - 0.55 * along**2)
    yaw = 2.4 * organ
    leaf = np.stack(
        [
            np.cos(yaw) * out - np.sin(yaw) * aside,
            np.sin(yaw) * out + np.cos(yaw) * aside,
            rise + 0.15 * across**2,
        ],
        axis=1,
    )
    return np.where((organ == LEAVES)[:, None], stem, leaf)
