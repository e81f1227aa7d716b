"""The one building block of every plant: a strip of tissue rolled about an axis.

A flat strip is a leaf, a half-rolled one a leaf in its whorl, a strip rolled right round a stem.
Material coordinates stay with the tissue for ever: `along` runs from 0 at the attachment to 1 at
the tip, `across` from -1 to 1 over the strip, with the midrib at 0.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

NODES = 65  # along every axis

Color = tuple[float, float, float]


class Change(NamedTuple):
    """A quantity's value at birth and when the part has opened."""

    young: float
    mature: float


NEVER = Change(0.0, 0.0)


@dataclass(frozen=True)
class Part:
    """What one part will ever be; lengths in mm, times in days, angles in radians.

    Where it belongs: `label` of its organ, the organ's `kind`, index of the `parent` part (-1:
    the ground), and the point `at` (0..1 along) and `azimuth` (about) the parent's axis.
    How it grows: from `birth`, for `duration`, to `length`. A positive `gradient` (below 1)
    grows the base first, as stems do, a negative one the tip first, as grass leaves do; it is the
    share of the duration by which the last tissue starts later than the first.
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

    lag: float = 0.7  # above 1 the width grows after the length, below 1 before it
    opening: float = 6.0  # days from birth to the mature posture
    upright: float = 0.0  # how far the base turns from the parent's axis (0) to the vertical (1)
    lean: Change = NEVER  # of the base, away from the parent's axis
    bend: Change = NEVER  # from base to tip, away from the parent's axis
    bend_power: float = 1.0  # above 1 the bend gathers towards the tip
    turn: float = 0.0  # about the parent's axis while opening
    twist: Change = NEVER  # about the own axis, from base to tip
    spin: float = 0.0  # about the own axis, all of it: which way a leaflet faces
    roll: Change = NEVER  # half of the cross-section's arc; pi is a closed tube
    clasp: float = 0.0  # further roll at the base, around the stem
    fold: float = 0.0  # slope of the halves of the blade about the midrib
    ruffle: float = 0.0  # height of the waves along the margins
    waves: float = 5.0  # how many of them
    phase: float = 0.0
    wobble: NDArray[np.float64] | None = None  # (NODES, 2) crookedness of the axis

    old: Color = (0.80, 0.72, 0.36)
    rib: Color | None = None  # colour of the midrib
    lifespan: float = np.inf  # days until the part starts to yellow


def blade(half_width: float, base: float, rise: float, fall: float) -> NDArray[np.float64]:
    """Half-widths (NODES,) of a leaf: `base` (share of the widest) at 0, a point at 1."""
    along = np.linspace(0, 1, NODES)
    swell = along**rise * (1 - along) ** fall
    peak = rise / (rise + fall)
    swell /= peak**rise * (1 - peak) ** fall
    return half_width * np.maximum(swell, base * (1 - along) ** 2)


def taper(base: float, tip: float) -> NDArray[np.float64]:
    """Radii (NODES,) of a tube, closed by a round cap at its tip."""
    along = np.linspace(0, 1, NODES)
    cap = np.sqrt(np.clip(1 - np.clip((along - 0.95) / 0.05, 0, 1) ** 2, 0, 1))
    return (base + (tip - base) * along) * cap


def crooked(rng: np.random.Generator, amount: float, cycles: float = 2.0) -> NDArray[np.float64]:
    """Slow random sideways turns of an axis, (NODES, 2), none of them at the base."""
    along = np.linspace(0, 1, NODES)[:, None]
    total = np.zeros((NODES, 2))
    for octave in (1.0, 2.3):
        phase = rng.uniform(0, 2 * np.pi, 2)
        size = rng.normal(0, amount / octave, 2)
        total += size * np.sin(2 * np.pi * cycles * octave * along + phase)
    return total * np.minimum(1, 8 * along)
