from .clip import Clip, check, open
from .errors import ClipError, UserError
from .evaluate import Frame, Layer
from .schema import (
    Box,
    Group,
    HeldOutScan,
    Interval,
    Motion,
    PointField,
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
    "HeldOutScan",
    "Interval",
    "Layer",
    "Motion",
    "PointField",
    "ScanMark",
    "SegmentPair",
    "Track",
    "UserError",
    "check",
    "open",
]
