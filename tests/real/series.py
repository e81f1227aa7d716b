"""Which series the tests of this folder run on.

Two are on every machine: the scans of ``examples/tomato``, which have no labels, and a maize that
is grown when the tests begin, whose organs are known. Further scans are taken in where they lie in
``../shared/data`` beside the checkout.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples" / "tomato"
SHARED = ROOT.parent / "shared" / "data"
GROWN = "grown maize"


def present(*names: str) -> list[str]:
    """Those of the shared files and folders that are on this machine."""
    return [name for name in names if (SHARED / name).exists()]


def labelled(*names: str) -> list[str]:
    """The grown series, and those of the shared ones that are on this machine."""
    return [GROWN, *present(*names)]


def tables_of(folder: Path) -> list[np.ndarray]:
    """The points and labels of each scan, about the middle of the first one."""
    tables = [np.loadtxt(path) for path in sorted(folder.glob("*.txt"))]
    middle = np.append(tables[0][:, :3].mean(axis=0), 0.0)
    return [table - middle for table in tables]
