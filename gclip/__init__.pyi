from .clip import Clip, check, open
from .errors import ClipError, UserError
from .evaluate import Frame, Layer
from .schema import (
    Box,
    Group,
    Interval,
    Motion,
    ScanMark,
    SegmentPair,
    Track,
)

__version__: str

__all__ = [
    "Box",
    "Clip",
    "ClipError",
    "Frame",
    "Group",
    "Interval",
    "Layer",
    "Motion",
    "ScanMark",
    "SegmentPair",
    "Track",
    "UserError",
    "check",
    "open",
]
