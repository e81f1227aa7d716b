"""What a plant module hands over: the parts, the organs' parents, and the usual scans."""

from dataclasses import dataclass

from grow.part import Part


@dataclass(frozen=True)
class Species:
    """A plant before it is posed.

    parts:       parents before children; the first part of a label is its organ's main axis.
    days:        first and last day at which the plant is meant to be seen.
    scan_days:   the usual scan days, in order.
    scan_points: points of the smallest and the largest of the usual scans.
    noise:       the usual scanner noise, standard deviation in mm.
    """

    parts: tuple[Part, ...]
    days: tuple[float, float]
    scan_days: tuple[float, ...]
    scan_points: tuple[int, int]
    noise: float
