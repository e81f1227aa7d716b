"""How large the plant is, in which unit, and whether all scans of it are in the same one."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError
from baker.scans.scan import Finding, Scan

METERS = {"mm": 1e-3, "cm": 1e-2, "dm": 0.1, "m": 1.0, "in": 0.0254, "inch": 0.0254, "ft": 0.3048}
PLANT_SIZES = (2e-3, 100.0)  # meters
# Of a scan against the one before: no plant grows so much, some may (a seedling and a grown plant).
MAX_RATIO, LIKELY_RATIO = 30.0, 8.0
UNITS = (1e-3, 1e-2, 0.1, 1.0, 0.0254)  # in meters, in which scans may be mixed
MIN_SIZE = 1e-100  # has a logarithm
MAX_SAMPLE = 20_000  # points of a scan that its size is found by


def require_one_unit(scans: Sequence[Scan], unit: str) -> Finding:
    """How large the plant is in its unit ("" where the user has not said it).

    Raises InputError where a scan is so much larger or smaller than the one before it that its unit
    must be another one.
    """
    sizes = [_size(scan.points) for scan in scans]
    short = [f"{float(f'{size:.3g}'):,g}" for size in sizes]
    logs = np.log(np.maximum(sizes, MIN_SIZE))
    off = np.abs(logs - np.median(logs))
    doubts = []
    for pair in pairwise(range(len(sizes))):
        other, odd = sorted(pair, key=off.__getitem__)
        ratio = float(np.exp(abs(logs[odd] - logs[other])))
        if ratio < LIKELY_RATIO or min(sizes[odd], sizes[other]) == 0.0:
            continue
        factors = [a / b for a in UNITS for b in UNITS]
        factor = min(factors, key=lambda f: abs(np.log(f) + logs[odd] - logs[other]))
        name = scans[odd].name
        said = (
            f"'{name}' is {short[odd]} across, '{scans[other].name}' {short[other]}, as if they "
            f"were in different units: multiply the coordinates of '{name}' by {factor:g}, or "
            "leave it out"
        )
        if ratio > MAX_RATIO:
            raise InputError(f"{said}.")
        doubts.append(said)
    meters = sizes[-1] * METERS.get(unit.lower(), 0.0)
    if meters and not PLANT_SIZES[0] <= meters <= PLANT_SIZES[1]:
        doubts.append(f"that is {meters:.2g} m")
    size = f"the last scan is {short[-1]} {unit}".rstrip() + " across"
    found = f"{unit}; {size}" if unit else f"that of the scans; {size} (--unit mm names it)"
    return Finding("unit", found, *doubts[:1])


def _size(cloud: NDArray[np.floating]) -> float:
    """The largest extent of a cloud, single stray points aside."""
    low, high = np.quantile(cloud[:: -(-len(cloud) // MAX_SAMPLE)], [0.005, 0.995], axis=0)
    return float((high - low).max())
