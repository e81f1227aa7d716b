"""Check that all scans of a series are in the same unit of length, and report their sizes."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError
from baker.scans.scan import Finding, Scan

METERS = {"mm": 1e-3, "cm": 1e-2, "dm": 0.1, "m": 1.0, "in": 0.0254, "inch": 0.0254, "ft": 0.3048}
PLANT_SIZES = (2e-3, 100.0)  # meters, of the smallest and the largest plant
MAX_RATIO = 30.0  # of the sizes of two successive scans; no plant grows by so much
LIKELY_RATIO = 8.0  # above which the units of the scans are doubted; few plants grow by so much
UNITS = (1e-3, 1e-2, 0.1, 1.0, 0.0254)  # units of length that are often mixed up, in meters
MIN_POINTS = 100  # of a scan; below, organs are hardly seen
STRAY_RATIO = 3.0  # size of a scan with its outermost points to that without; real ones 1.12
MIN_SIZE = 1e-100  # replaces 0, which has no logarithm
MAX_SAMPLE = 20_000  # points of a scan from which its size is estimated


def require_one_unit(scans: Sequence[Scan], unit: str) -> Finding:
    """Report the size of the plant, and doubt that scans have one unit if their sizes differ much.

    unit: of the scans' lengths, "" where it is not known. Raises InputError if the sizes of
    successive scans differ so much that their units must be different.
    """
    sizes = [_size(scan.points) for scan in scans]
    rounded = [f"{float(f'{size:.3g}'):,g}" for size in sizes]
    logs = np.log(np.maximum(sizes, MIN_SIZE))
    deviation = np.abs(logs - np.median(logs))
    factors = [a / b for a in UNITS for b in UNITS]
    doubts = []
    for pair in pairwise(range(len(sizes))):
        usual, odd = sorted(pair, key=deviation.__getitem__)
        ratio = np.exp(logs[usual] - logs[odd])
        if 1 / LIKELY_RATIO < ratio < LIKELY_RATIO or min(sizes[odd], sizes[usual]) == 0.0:
            continue
        expected_log = np.interp(odd, np.delete(range(len(logs)), odd), np.delete(logs, odd))
        factor = min(factors, key=lambda factor: abs(np.log(factor) + logs[odd] - expected_log))
        name = scans[odd].name
        doubt = (
            f"'{name}' is {rounded[odd]} across, '{scans[usual].name}' {rounded[usual]}, as if they"
            f" were in different units: multiply the coordinates of '{name}' by {factor:g}, or "
            "leave it out"
        )
        if not 1 / MAX_RATIO <= ratio <= MAX_RATIO:
            raise InputError(f"{doubt}.")
        doubts.append(doubt)
    meters = sizes[-1] * METERS.get(unit.lower(), 0.0)
    if meters and not PLANT_SIZES[0] <= meters <= PLANT_SIZES[1]:
        doubts.append(f"that is {meters:.2g} m")
    size = f"the last scan is {rounded[-1]} {unit}".rstrip() + " across"
    description = f"{unit}; {size}" if unit else f"that of the scans; {size} (--unit mm names it)"
    return Finding("unit", description, *doubts[:1])


def points_finding(scans: Sequence[Scan]) -> Finding:
    """Report the numbers of points, and doubt scans that have few points or some far away."""
    counts = sorted({len(scan) for scan in scans})
    found = " to ".join(f"{count:,}" for count in dict.fromkeys((counts[0], counts[-1])))
    doubt = option = ""
    for scan in scans:
        size = float(np.ptp(scan.points, axis=0).max())
        if size > STRAY_RATIO * _size(scan.points):
            doubt = f"some of '{scan.name}' are far from the rest, all are {size:.3g} across"
            option = "--outliers 2"
        elif len(scan) < MIN_POINTS:
            doubt, option = f"'{scan.name}' has only {len(scan)}", ""
    return Finding("points", f"{len(scans)} scans of {found}", doubt, option)


def _size(cloud: NDArray[np.floating]) -> float:
    """The longest side of the bounding box of (N, 3) points, without their outermost 1 %."""
    low, high = np.quantile(cloud[:: -(-len(cloud) // MAX_SAMPLE)], [0.005, 0.995], axis=0)
    return float((high - low).max())
