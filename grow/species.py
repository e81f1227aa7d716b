"""The result of a plant module: the parts of a plant and its default scans."""

from dataclasses import dataclass

from grow.part import Part


@dataclass(frozen=True)
class Species:
    """The parameters of a plant.

    parts:       parents before children; the first part of an organ is on its main axis.
    days:        first and last day for which the plant is designed.
    scan_days:   days of the default scans, ascending.
    scan_points: numbers of points of the first and last default scan.
    noise:       default standard deviation of the noise in mm.
    """

    parts: tuple[Part, ...]
    days: tuple[float, float]
    scan_days: tuple[float, ...]
    scan_points: tuple[int, int]
    noise: float
