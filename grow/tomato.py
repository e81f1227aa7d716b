"""Tomato: a leaning stem, two cotyledons, and compound leaves with leaflets in a spiral."""

import numpy as np
from numpy.typing import NDArray

from grow.part import NODES, Change, Part, blade_outline, random_deviations, tapered_radii
from grow.species import Species

LEAVES = 9  # number of compound leaves
STEM_BIRTH, STEM_DAYS, APICAL = -9.0, 30.0, 0.6  # birth, duration and gradient of the stem
GOLDEN_ANGLE = np.pi * (3 - 5**0.5)  # radians, between successive leaves
# Colours, sRGB from 0 to 1.
STEM, STALK = (0.56, 0.70, 0.36), (0.50, 0.68, 0.30)
YOUNG, MATURE, RIB = (0.54, 0.76, 0.28), (0.16, 0.44, 0.16), (0.50, 0.68, 0.34)


def grow(rng: np.random.Generator) -> Species:
    """A tomato that grows from its cotyledons to its ninth leaf in eight days."""
    parts = [_stem(rng)]
    azimuth = rng.uniform(0, 2 * np.pi)
    for side in range(2):
        parts += _cotyledon(rng, side + 1, azimuth + np.pi * side + rng.normal(0, 0.1))
    azimuth += np.pi / 2
    for rank in range(LEAVES):
        parts += _leaf(rng, rank, len(parts), azimuth)
        azimuth += GOLDEN_ANGLE + rng.normal(0, 0.12)
    return Species(tuple(parts), (0.0, 10.0), tuple(range(9)), (4000, 16000), 0.15)


def _position_at_birth(birth: float) -> float:
    """The position on the stem of an organ born at a time: where elongation has just started."""
    return (birth - 0.9 - STEM_BIRTH) / (APICAL * STEM_DAYS)


def _stem(rng: np.random.Generator) -> Part:
    along = np.linspace(0, 1, NODES)
    return Part(
        label=0,
        kind="stem",
        parent=-1,
        at=0.0,
        azimuth=0.0,
        birth=STEM_BIRTH,
        duration=STEM_DAYS,
        length=270.0,
        gradient=APICAL,
        width=3.4 * (1 - along) ** 0.35,
        tube=True,
        young=STEM,
        mature=(0.44, 0.56, 0.27),
        deviations=random_deviations(rng, 0.07, 2.5),
    )


def _cotyledon(rng: np.random.Generator, label: int, azimuth: float) -> list[Part]:
    """A stalk and a simple blade; the stem is part 0, and each cotyledon has two parts."""
    stalk = Part(
        label=label,
        kind="cotyledon",
        parent=0,
        at=_position_at_birth(-5.8),
        azimuth=azimuth,
        birth=-5.8,
        duration=7.0,
        length=11.0,
        width=tapered_radii(1.0, 0.8),
        tube=True,
        young=STALK,
        mature=STALK,
        opening=8.0,
        upright=0.5,
        lean=Change(0.1, 1.1),
        bend=Change(0.0, 0.35),
    )
    lamina = Part(
        label=label,
        kind="cotyledon",
        parent=2 * label - 1,
        at=1.0,
        azimuth=np.pi,
        birth=-5.7,
        duration=8.0,
        length=rng.uniform(25, 29),
        width=blade_outline(5.2, 0.15, 0.7, 0.8),
        tube=False,
        young=YOUNG,
        mature=(0.26, 0.54, 0.18),
        rib=RIB,
        opening=6.0,
        bend=Change(-0.1, 0.5),
        roll=Change(1.2, 0.15),
        lifespan=rng.uniform(12.0, 14.0),
    )
    return [stalk, lamina]


def _leaf(rng: np.random.Generator, rank: int, first: int, azimuth: float) -> list[Part]:
    """A stalk with pairs of leaflets and a terminal one; `first` is the index of the stalk."""
    birth = -4.2 + 1.12 * rank + rng.uniform(-0.2, 0.2)
    length = np.interp(rank, [0, 2, 5, LEAVES], [66, 110, 150, 150]) * rng.uniform(0.93, 1.07)
    stalk = Part(
        label=rank + 3,
        kind="leaf",
        parent=0,
        at=_position_at_birth(birth),
        azimuth=azimuth,
        birth=birth,
        duration=10.0,
        length=length,
        width=tapered_radii(1.7, 0.8),
        tube=True,
        young=STALK,
        mature=(0.42, 0.58, 0.26),
        opening=rng.uniform(6.0, 7.5),
        upright=0.35,
        lean=Change(0.15, rng.uniform(0.75, 0.95)),
        bend=Change(-0.25, rng.uniform(0.75, 1.15)),
        bend_power=1.3,
        turn=rng.normal(0, 0.2),
        deviations=random_deviations(rng, 0.05, 1.2),
    )
    parts = [stalk, _leaflet(rng, stalk, first, 1.0, 0, 0.50 * length)]
    pairs = 1 if rank == 0 else 2 if rank < 3 else 3
    for pair in range(pairs):
        position = np.interp(pair, [0, max(pairs - 1, 1)], [0.82 if pairs > 1 else 0.62, 0.38])
        size = length * (0.42 - 0.04 * pair) * (0.8 if rank == 0 else 1)
        parts += [_leaflet(rng, stalk, first, position, side, size) for side in (-1, 1)]
        if rank > 2 and pair < 2:  # the small leaflets between the pairs
            parts += [
                _leaflet(rng, stalk, first, position - 0.11, side, 0.28 * size) for side in (-1, 1)
            ]
    return parts


def _leaflet(
    rng: np.random.Generator, stalk: Part, parent: int, at: float, side: int, length: float
) -> Part:
    """A leaflet on the left (-1) or right (1) side of the stalk, or at its end (0)."""
    along = np.linspace(0, 1, NODES)
    slopes = np.zeros((NODES, 2))
    slopes[:, 1] = -side * rng.uniform(0.45, 0.8) * along
    spread = rng.uniform(1.0, 1.3)
    length = length * rng.uniform(0.9, 1.1)
    return Part(
        label=stalk.label,
        kind="leaf",
        parent=parent,
        at=at if side == 0 else at + rng.uniform(-0.03, 0.03),
        azimuth=side * np.pi / 2 if side else np.pi,
        birth=stalk.birth + 0.3 + 1.6 * (1 - at),
        duration=9.0,
        length=length,
        width=_lobed(0.36 * length, 4 if length > 30 else 3, rng.uniform(0.16, 0.24)),
        tube=False,
        young=YOUNG,
        mature=MATURE,
        rib=RIB,
        opening=rng.uniform(5.0, 6.5),
        lean=Change(0.25, spread) if side else Change(0.0, 0.1),
        bend=Change(0.0, -0.3) if side else Change(-0.1, 0.7),
        spin=-side * np.pi / 2,
        twist=Change(0.0, rng.normal(0, 0.15)),
        roll=Change(1.9, 0.25),
        fold=0.22,
        ruffle=0.035 * length,
        waves=3.0,
        phase=rng.uniform(0, 2 * np.pi),
        deviations=slopes,
    )


def _lobed(half_width: float, lobes: int, depth: float) -> NDArray[np.float64]:
    """(NODES,) half-widths of a stalked, pointed leaflet with teeth."""
    along = np.linspace(0, 1, NODES)
    inner = np.clip((along - 0.13) / 0.87, 0, 1)
    outline = 1.9 * inner**0.55 * (1 - inner) ** 0.95
    tooth = (lobes * inner**0.9) % 1.0
    outline = outline * (1 + depth * (tooth**1.5 - 0.6))
    return half_width * np.maximum(outline, 0.07 * (1 - along))
