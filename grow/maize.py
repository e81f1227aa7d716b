"""Maize: a stem with leaves in two ranks, which rise from the whorl, unroll, turn and droop."""

import numpy as np

from grow.part import NODES, Change, Part, blade_outline, random_deviations
from grow.species import Species

LEAVES = 10  # number of leaves
STEM_BIRTH, STEM_DAYS, APICAL = -10.0, 42.0, 0.6  # birth, duration and gradient of the stem
# Colours, sRGB from 0 to 1.
YOUNG, MATURE, RIB = (0.60, 0.80, 0.27), (0.18, 0.47, 0.14), (0.70, 0.84, 0.50)


def grow(rng: np.random.Generator) -> Species:
    """A maize seedling, from its second leaf to its ninth in two weeks."""
    parts = [_stem(rng)]
    azimuth = rng.uniform(0, 2 * np.pi)
    for rank in range(LEAVES):
        azimuth += np.pi + rng.normal(0.05, 0.16)
        parts.append(_leaf(rng, rank, azimuth))
    return Species(tuple(parts), (0.0, 16.0), tuple(range(0, 15, 2)), (1700, 5000), 0.35)


def _stem(rng: np.random.Generator) -> Part:
    along = np.linspace(0, 1, NODES)
    radius = 9.0 * (1 - along) ** 0.4 * (1 - 0.35 * along)
    return Part(
        label=0,
        kind="stem",
        parent=-1,
        at=0.0,
        azimuth=0.0,
        birth=STEM_BIRTH,
        duration=STEM_DAYS,
        length=640.0,
        gradient=APICAL,
        width=radius,
        tube=True,
        young=(0.66, 0.80, 0.42),
        mature=(0.52, 0.62, 0.30),
        deviations=random_deviations(rng, 0.03, 1.5),
    )


def _leaf(rng: np.random.Generator, rank: int, azimuth: float) -> Part:
    order = rank / (LEAVES - 1)
    birth = -6.5 + 1.9 * rank + rng.uniform(-0.3, 0.3)
    length = np.interp(order, [0, 0.25, 0.6, 0.85, 1], [95, 260, 520, 560, 480])
    half_width = np.interp(order, [0, 0.25, 0.6, 1], [8, 13, 26, 28])
    width = blade_outline(half_width, 0.55, 0.45, 0.75 if rank else 0.4)
    droop = np.interp(order, [0, 0.3, 1], [1.2, 2.4, 1.8]) + rng.normal(0, 0.15)
    return Part(
        label=rank + 1,
        kind="leaf",
        parent=0,
        # A leaf is attached to tissue of the stem that has just started to elongate.
        at=(birth - 1.8 - STEM_BIRTH) / (APICAL * STEM_DAYS),
        azimuth=azimuth,
        birth=birth,
        duration=13.0,
        length=length * rng.uniform(0.92, 1.08),
        gradient=-0.25,
        width=width,
        tube=False,
        young=YOUNG,
        mature=MATURE,
        rib=RIB,
        opening=rng.uniform(9.5, 11.5),
        lean=Change(0.02, rng.uniform(0.32, 0.55)),
        bend=Change(0.05, droop),
        bend_power=rng.uniform(1.4, 1.9),
        turn=rng.normal(0, 0.28),
        twist=Change(0.0, rng.normal(0, 0.45)),
        roll=Change(2.4, 0.22),
        clasp=1.3,
        fold=0.28,
        ruffle=rng.uniform(2.0, 4.5) * order**0.5,
        waves=rng.uniform(4.0, 6.5),
        phase=rng.uniform(0, 2 * np.pi),
        deviations=random_deviations(rng, 0.05, 0.9),
        lifespan=15.0 + 6 * rank,
    )
