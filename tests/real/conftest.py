"""The series by their names (see series.py), and a bake of the example."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from baker import Options, bake
from gclip import Clip
from grow.series import Plan, write_series
from tests.real.series import EXAMPLE, GROWN, SHARED


@pytest.fixture(scope="session")
def grown(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Five scans of a maize of nine organs, as text, with the labels that `grow` knows."""
    folder = tmp_path_factory.mktemp("grown") / "maize"
    write_series(Plan("maize", scans=5, points=(4000, 8000), suffix="txt", colors=False), folder)
    return folder


@pytest.fixture(scope="session")
def series(grown: Path) -> Callable[[str], Path]:
    """The folder of a series."""
    return lambda name: grown if name == GROWN else SHARED / name


@pytest.fixture(scope="session")
def example() -> Clip:
    """The example's scans, baked as a user would."""
    return bake([EXAMPLE], Options(workers=1))
