"""The building block of all plants: a strip of tissue, rolled about an axis.

A flat strip is a leaf, a partly rolled one a young leaf, a closed one a stem. The material
coordinates of tissue never change: `along` is 0 at the attachment and 1 at the tip, `across` is -1
to 1 over the width of the strip, 0 at the midrib.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

NODES = 65  # number of nodes along every axis

Color = tuple[float, float, float]
"""sRGB, each from 0 to 1."""


class Change(NamedTuple):
    """The value of a quantity at birth and when the part has opened."""

    young: float
    mature: float


NO_CHANGE = Change(0.0, 0.0)


@dataclass(frozen=True)
class Part:
    """The parameters of one part; lengths in mm, times in days, angles in radians.

    Attachment: `label` and `kind` of its organ, index of the `parent` part (-1 for the ground), and
    the position `at` (0 to 1 along) and `azimuth` (around) the parent's axis.
    Growth: from `birth`, for `duration`, to `length`. With a positive `gradient` (below 1) the base
    grows first, as in stems, with a negative one the tip, as in leaves of grass; it is the share of
    the duration by which the last tissue starts later than the first.
    """

    label: int
    kind: str
    parent: int
    at: float
    azimuth: float

    birth: float
    duration: float
    length: float
    width: NDArray[np.float64]  # (NODES,) mature radius of a tube, or half-width of a strip
    tube: bool
    young: Color
    mature: Color
    gradient: float = 0.0

    lag: float = 0.7  # exponent: above 1 the width grows after the length, below 1 before it
    opening: float = 6.0  # days from birth to the mature posture
    upright: float = 0.0  # direction of the base, from the parent's axis (0) to the vertical (1)
    lean: Change = NO_CHANGE  # of the base, away from the parent's axis
    bend: Change = NO_CHANGE  # from base to tip, away from the parent's axis
    bend_power: float = 1.0  # above 1 the bend is greatest near the tip
    turn: float = 0.0  # rotation about the parent's axis while opening
    twist: Change = NO_CHANGE  # rotation of the tip about its own axis, against the base
    spin: float = 0.0  # constant rotation about its own axis: the direction that a leaflet faces
    roll: Change = NO_CHANGE  # half of the cross-section's arc; pi is a closed tube
    clasp: float = 0.0  # further roll at the base, around the stem
    fold: float = 0.0  # slope of the halves of the blade about the midrib
    ruffle: float = 0.0  # height of the waves along the margins
    waves: float = 5.0  # number of these waves
    phase: float = 0.0  # of these waves, radians
    deviations: NDArray[np.float64] | None = None  # (NODES, 2) slopes of the axis to both sides

    old: Color = (0.80, 0.72, 0.36)  # colour of yellowed tissue
    rib: Color | None = None  # colour of the midrib
    lifespan: float = np.inf  # days until the part starts to yellow


def blade_outline(half_width: float, base: float, rise: float, fall: float) -> NDArray[np.float64]:
    """(NODES,) half-widths of a leaf with a pointed tip: those of a beta distribution's density.

    half_width: the maximum. base: least half-width at the base, as a share of the maximum. rise,
    fall: exponents of the outline at base and tip.
    """
    along = np.linspace(0, 1, NODES)
    outline = along**rise * (1 - along) ** fall
    peak = rise / (rise + fall)
    outline /= peak**rise * (1 - peak) ** fall
    return half_width * np.maximum(outline, base * (1 - along) ** 2)


def tapered_radii(base: float, tip: float) -> NDArray[np.float64]:
    """(NODES,) radii of a tube with a round cap at its tip."""
    along = np.linspace(0, 1, NODES)
    cap = np.sqrt(np.clip(1 - np.clip((along - 0.95) / 0.05, 0, 1) ** 2, 0, 1))
    return (base + (tip - base) * along) * cap


def random_deviations(
    rng: np.random.Generator, amount: float, cycles: float = 2.0
) -> NDArray[np.float64]:
    """(NODES, 2) smooth random slopes of an axis to both sides, 0 at the base.

    amount: standard deviation. cycles: number of waves along the axis.
    """
    along = np.linspace(0, 1, NODES)[:, None]
    total = np.zeros((NODES, 2))
    for octave in (1.0, 2.3):
        phase = rng.uniform(0, 2 * np.pi, 2)
        amplitude = rng.normal(0, amount / octave, 2)
        total += amplitude * np.sin(2 * np.pi * cycles * octave * along + phase)
    return total * np.minimum(1, 8 * along)
