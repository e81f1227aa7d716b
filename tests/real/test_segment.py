"""Scans without labels: the organs found are those that people marked, or `grow` knows."""

import numpy as np
import plyfile
import pytest

from baker import Options, bake
from baker.alignment.stem_base import base_point
from baker.geometry.up_axis import Vertical
from baker.segmentation.organs import find_organs
from baker.segmentation.reeb_graph import sample_plant
from tests.real.series import EXAMPLE, GROWN, labelled, present, tables_of

UP = Vertical.named("z")
SMALLEST_GROWN_ORGAN = 300  # points; `grow` also labels what still hides in the stem
SERIES = (
    "maize_control_plant1",
    "sorghum_control_plant1",
    "tobacco_heat_plant3",
    "tomato1_control2_plant1",
    "tomato2_control_plant3",
)


def overlaps(table: np.ndarray, numbers: np.ndarray, name: str) -> list[float]:
    """Of each organ of a scan, the best intersection over union with an organ found."""
    return [
        max((own & (numbers == n)).sum() / (own | (numbers == n)).sum() for n in set(numbers[own]))
        for own in (table[:, 3] == label for label in np.unique(table[:, 3]))
        if name != GROWN or own.sum() >= SMALLEST_GROWN_ORGAN
    ]


@pytest.mark.parametrize("name", labelled(*SERIES))
def test_organs_overlap_with_those_marked(series, name):
    tables = tables_of(series(name))
    clouds = [table[:, :3] for table in tables]
    bases = [base_point(cloud, UP) for cloud in clouds]
    found = map(find_organs, clouds, bases)
    scans = zip(tables, found, strict=True)
    overlap = [share for scan in scans for share in overlaps(*scan, name)]
    assert np.mean(overlap) > (0.75 if name == GROWN else 0.8)


@pytest.mark.parametrize("name", present("tobacco_control_plant1"))
def test_leaves_found_by_shape_grow_from_the_stem(series, name):
    """The blade of one of them is nearer to another leaf than its own base is to the stem."""
    clip = bake(series(name), Options(align="none", labels="ignore"))
    parents = [track.parent for track in clip.track_table]
    assert parents == [None, *[0] * (len(parents) - 1)]


@pytest.mark.parametrize("name", present(*SERIES))
def test_a_quarter_of_the_points_is_enough(series, name):
    rng = np.random.default_rng(0)
    sparse = [table[rng.random(len(table)) < 0.25] for table in tables_of(series(name))]
    bases = [base_point(table[:, :3], UP) for table in sparse]
    found = [find_organs(t[:, :3], base) for t, base in zip(sparse, bases, strict=True)]
    scans = zip(sparse, found, strict=True)
    overlap = [share for scan in scans for share in overlaps(*scan, name)]
    assert np.mean(overlap) > 0.75


def test_the_diameter_of_a_stem_hardly_depends_on_the_sample():
    """The standard deviation is 8 and 5 % with a single set of sections."""
    spread = []
    for path in sorted(EXAMPLE.glob("*.ply")):
        vertex = plyfile.PlyData.read(path)["vertex"]
        cloud = np.stack([vertex[axis] for axis in "xyz"], axis=1).astype(np.float64)
        samples = [cloud[np.random.default_rng(s).random(len(cloud)) < 0.9] for s in range(12)]
        measured = [sample_plant(sample, base_point(sample, UP)).diameter for sample in samples]
        spread.append(np.std(measured) / np.mean(measured))
    assert np.mean(spread) < 0.05
