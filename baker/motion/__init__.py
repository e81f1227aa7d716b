"""How organs bend and turn between two scans: spines, a coherent warp, curved paths."""

from baker.motion.attach import attached
from baker.motion.curve import Motions, Shapes, curved, organ_motions, shaping
from baker.motion.organ import OrganMotion, fit_motion

__all__ = [
    "Motions",
    "OrganMotion",
    "Shapes",
    "attached",
    "curved",
    "fit_motion",
    "organ_motions",
    "shaping",
]
