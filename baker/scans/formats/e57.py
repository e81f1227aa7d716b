"""Read E57 (ASTM E2807) with pye57, which the extra `e57` installs; its scans are concatenated."""

from contextlib import closing
from pathlib import Path

import numpy as np

from baker.scans.formats import Columns, FormatError

POSITIONS = {"cartesianX": "x", "cartesianY": "y", "cartesianZ": "z"}
COLORS = {"colorRed": "red", "colorGreen": "green", "colorBlue": "blue"}


def read(path: Path) -> Columns:
    """Read x, y, z in the file's frame and, if all scans have them, red, green, blue."""
    try:
        import pye57
    except ImportError:
        raise FormatError(
            'can\'t be read without pye57: pip install "plant-growth-clips[e57]".'
        ) from None

    with closing(pye57.E57(str(path))) as file:
        wanted = {"colors": True, "ignore_missing_fields": True, "transform": True}
        scans = [file.read_scan(k, **wanted) for k in range(file.scan_count)]
    have_colors = all(set(COLORS) <= set(scan) for scan in scans)
    names = POSITIONS | COLORS if have_colors else POSITIONS
    return Columns(
        {name: np.concatenate([scan[field] for scan in scans]) for field, name in names.items()}
    )
