from .clip import Clip, HeldOutScan, PointField, Track, open
from .errors import ClipError, UserError
from .evaluate import Frame, Layer
from .schema import Box, Group, Interval, Motion, ScanMark, SegmentPair

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
    "open",
]
