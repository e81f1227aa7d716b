"""The result of a plant module: the parts of a plant and its default scans."""

from dataclasses import dataclass

from grow.part import Part


@dataclass(frozen=True)
class Species:
    """The parameters of a plant."""

    parts: tuple[Part, ...]  # parents before children; an organ's first part is on its main axis
    days: tuple[float, float]  # first and last day for which the plant is designed
    scan_days: tuple[float, ...]  # days of the default scans, ascending
    scan_points: tuple[int, int]  # numbers of points of the first and last default scan
    noise: float  # default standard deviation of the noise, mm
