"""The growth clip: data model, file, and evaluation on the CPU (docs/format.md).

import gclip
clip = gclip.open("plant.gclip")   # memory-mapped and fully checked, or gclip.ClipError
frame = clip.at(12.5)              # the plant on day 12.5, the same maths as the shader
"""

from typing import TYPE_CHECKING, Any

from gclip.errors import ClipError, UserError

if TYPE_CHECKING:
    from gclip.clip import (
        Box,
        Clip,
        Group,
        HeldOutScan,
        Interval,
        Motion,
        ScanMark,
        SegmentPair,
        Track,
    )
    from gclip.evaluate import Frame, Layer
    from gclip.file import open_clip as open

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
    "ScanMark",
    "SegmentPair",
    "Track",
    "UserError",
    "open",
]

_HOME = dict.fromkeys(
    (
        *("Box", "Clip", "Group", "HeldOutScan", "Interval", "Motion", "ScanMark"),
        *("SegmentPair", "Track"),
    ),
    "gclip.clip",
) | {"Frame": "gclip.evaluate", "Layer": "gclip.evaluate", "open": "gclip.file"}


def __getattr__(name: str) -> Any:
    """Load numpy and the container library only when a clip is touched: `--help` stays instant."""
    if name not in _HOME:
        raise AttributeError(f"module 'gclip' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_HOME[name]), "open_clip" if name == "open" else name)
