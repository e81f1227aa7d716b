"""A small plant that grows, written as scans."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

ScanWriter = Callable[..., Path]


def plant_on(day: float, seed: int) -> np.ndarray:
    """(N, 4) x y z label: a stem, and leaves 1 to 3 of which one is born each day."""
    rng = np.random.default_rng([seed, int(10 * day)])
    rods = [(0, np.zeros(3), np.array([0, 0, 10 + 2 * day]), 400)]
    for leaf in range(1, 4):
        age = day - leaf + 2
        if age > 0:
            azimuth = 2.4 * leaf
            base = np.array([0, 0, 2.0 + 2 * leaf])
            reach = age * np.array([2 * np.cos(azimuth), 2 * np.sin(azimuth), 1.0])
            rods.append((leaf, base, base + reach, 150 + 20 * leaf))
    rows = []
    for label, start, end, count in rods:
        along = np.sort(rng.random((count, 1)), axis=0)
        points = start + along * (end - start) + rng.normal(0, 0.03, (count, 3))
        rows.append(np.column_stack([points, np.full(count, label)]))
    return np.concatenate(rows)


def write_las(folder: Path, days=(0, 1)) -> Path:
    """Write a series of the plant as LAZ into a folder and return it."""
    import laspy

    folder.mkdir(parents=True)
    for day in days:
        rows = plant_on(day, seed=0)
        las = laspy.create(point_format=3, file_version="1.2")
        las.header.scales = np.full(3, 1e-4)
        las.x, las.y, las.z = rows[:, :3].T
        las.classification = rows[:, 3].astype(np.uint8)
        las.write(folder / f"day{day:02d}.laz")
    return folder


def write_series(
    folder: Path,
    days=(0, 1, 2),
    labels: str = "names",
    reverse: bool = False,
    without: int | None = None,
    gone: int = 1,
) -> Path:
    """Write a series of the plant into a folder and return it.

    days: the scans' days; labels: "names", "shuffled" or "none"; reverse: the last scan first;
    without: a label that scans from `gone` on no longer have.
    """
    folder.mkdir(exist_ok=True)
    clouds = [plant_on(day, seed=0) for day in days]
    for k, cloud in enumerate(reversed(clouds) if reverse else clouds):
        kept = cloud[(cloud[:, 3] != without) | (k < gone)]
        if labels == "shuffled":
            names = np.random.default_rng(k).permutation(10)
            kept[:, 3] = names[kept[:, 3].astype(int)]
        columns = 3 if labels == "none" else 4
        np.savetxt(folder / f"day{k:02d}.txt", kept[:, :columns], fmt="%.4f")
    return folder


@pytest.fixture
def write_scans(tmp_path) -> ScanWriter:
    """`write_series`, into a folder of that name (scans) in the test's own."""
    return lambda *days, name="scans", **named: write_series(tmp_path / name, *days, **named)


@pytest.fixture
def read_points() -> Callable[[Path], np.ndarray]:
    """(N, 3) positions of a scan that `write_scans` wrote."""
    return lambda path: np.loadtxt(path)[:, :3]
