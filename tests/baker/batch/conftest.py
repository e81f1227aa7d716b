"""A few small plants, each in its folder."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

Greenhouse = Callable[..., Path]


def sprout(day: float, seed: int) -> np.ndarray:
    """(N, 4) x y z label: a stem that grows, and a leaf."""
    rng = np.random.default_rng([seed, int(day)])
    along = np.sort(rng.random((120, 1)), axis=0)
    stem = along * [0, 0, 8 + day + seed % 3]
    leaf = [0, 0, 3] + along[:60] * [2 + day, seed % 5, 1 + day]
    points = np.concatenate([stem, leaf]) + rng.normal(0, 0.02, (180, 3))
    return np.column_stack([points, np.repeat([0, 1], [120, 60])])


def write_plant(folder: Path, seed: int, days: int = 2) -> Path:
    folder.mkdir(parents=True)
    for day in range(days):
        np.savetxt(folder / f"day{day:02d}.txt", sprout(day, seed), fmt="%.4f")
    return folder


def write_greenhouse(folder: Path, names: list[str], days: int = 2) -> Path:
    for seed, name in enumerate(names):
        write_plant(folder / name, seed, days)
    return folder


@pytest.fixture
def greenhouse(tmp_path) -> Greenhouse:
    """Write plants into tmp_path/house and return that."""
    return lambda names, days=2: write_greenhouse(tmp_path / "house", names, days)
