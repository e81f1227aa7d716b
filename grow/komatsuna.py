"""Komatsuna (Brassica rapa): a rosette of spoon-shaped leaves in a golden spiral, almost stemless.

Seen from above, its leaves overlap, as in the data of Uchiyama et al. (2017).
"""

import numpy as np

from grow.part import NODES, Change, Part, blade_outline, random_deviations
from grow.species import Species

LEAVES = 10  # number of leaves
GOLDEN_ANGLE = np.pi * (3 - 5**0.5)  # radians, between successive leaves
# Colours, sRGB from 0 to 1.
YOUNG, MATURE, RIB = (0.58, 0.80, 0.30), (0.20, 0.52, 0.17), (0.72, 0.86, 0.55)


def grow(rng: np.random.Generator) -> Species:
    """A seedling that grows from three to ten leaves in ten days; the label of the stem is 0."""
    parts = [_stem()]
    azimuth = rng.uniform(0, 2 * np.pi)
    for rank in range(LEAVES):
        parts.append(_leaf(rng, rank, azimuth))
        azimuth += GOLDEN_ANGLE + rng.normal(0, 0.1)
    return Species(tuple(parts), (0.0, 12.0), tuple(range(11)), (4000, 40000), 0.3)


def _stem() -> Part:
    return Part(
        label=0,
        kind="stem",
        parent=-1,
        at=0.0,
        azimuth=0.0,
        birth=-20.0,
        duration=40.0,
        length=22.0,
        width=np.linspace(3.5, 1.5, NODES),
        tube=True,
        young=(0.66, 0.80, 0.42),
        mature=(0.60, 0.72, 0.40),
    )


def _leaf(rng: np.random.Generator, rank: int, azimuth: float) -> Part:
    order = rank / (LEAVES - 1)
    length = np.interp(order, [0, 0.3, 1], [62, 95, 118]) * rng.uniform(0.93, 1.07)
    half_width = length * rng.uniform(0.20, 0.24)
    return Part(
        label=rank + 1,
        kind="leaf",
        parent=0,
        at=0.25 + 0.6 * order,
        azimuth=azimuth,
        birth=-7.5 + 1.8 * rank + rng.uniform(-0.3, 0.3),
        duration=13.0,
        length=length,
        width=blade_outline(half_width, 0.13, 2.4, 0.75),
        tube=False,
        young=YOUNG,
        mature=MATURE,
        rib=RIB,
        opening=10.0,
        lean=Change(0.12, rng.uniform(0.75, 1.0)),
        bend=Change(-0.05, rng.uniform(0.25, 0.6)),
        turn=rng.normal(0, 0.15),
        twist=Change(0.0, rng.normal(0, 0.15)),
        roll=Change(1.4, 0.2),
        fold=0.12,
        ruffle=rng.uniform(0.8, 2.0),
        phase=rng.uniform(0, 2 * np.pi),
        deviations=random_deviations(rng, 0.05),
    )
