"""How organs bend and turn between two scans: spines, a coherent warp, curved paths."""

from baker.motion.attach import attached
from baker.motion.curve import Bend, Bending
from baker.motion.organ import OrganMotion, fit_motion

__all__ = [
    "Bend",
    "Bending",
    "OrganMotion",
    "attached",
    "fit_motion",
]
