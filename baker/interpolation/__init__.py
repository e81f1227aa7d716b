"""How organs bend and turn between two scans: spines, a coherent warp, curved paths."""

from baker.interpolation.organ_motion import OrganMotion, fit_motion
from baker.interpolation.paths import Bend, Bending

__all__ = [
    "Bend",
    "Bending",
    "OrganMotion",
    "fit_motion",
]
