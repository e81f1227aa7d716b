"""Real scans of every kind that lies in ../shared/data are read whole."""

import time

import numpy as np
import pytest

from baker.scans import ReadOptions, read_series
from baker.scans.fields import choose_fields
from baker.scans.formats import read_columns

SERIES = {
    "maize_control_plant1": range(9),
    "tomato2_control_plant3": range(9),
    "sorghum_control_plant1": range(2, 15, 2),
    "tobacco_heat_plant3": range(0, 9, 2),
    "tomato1_control2_plant1": range(0, 15, 2),
    "unaligned/maize_control_plant1": range(9),
    "unaligned/tomato2_control_plant3": range(9),
    "unaligned/sorghum_control_plant1": range(2, 15, 2),
}


@pytest.mark.parametrize("name", SERIES)
def test_labelled_series(shared_data, name):
    series = read_series([shared_data / name])
    assert [scan.time for scan in series.scans] == list(SERIES[name])
    for scan in series.scans:
        table = np.loadtxt(scan.path)
        unique = np.unique(table[:, :3].astype(np.float32), axis=0)
        np.testing.assert_array_equal(np.unique(scan.points, axis=0), unique)
        assert len(scan) == len(unique)
        assert set(scan.labels.tolist()) <= set(table[:, 3].astype(int).tolist())
        assert scan.origin.tolist() == [0, 0, 0]


@pytest.mark.parametrize("name", [name for name in SERIES if "/" not in name])
def test_labels_of_careful_hands_are_hardly_touched(shared_data, name):
    as_is, mended = (
        read_series([shared_data / name], ReadOptions(look_around=mend)).scans
        for mend in (False, True)
    )
    for one, other in zip(as_is, mended, strict=True):
        assert (one.labels != other.labels).sum() <= 1e-3 * len(one)


def test_full_resolution_tomato(shared_data):
    folder = shared_data / "tomato_fullres"
    read_series([folder])  # imports
    start = time.perf_counter()
    series = read_series([folder])
    assert time.perf_counter() - start < 2

    assert [scan.date for scan in series.scans] == ["2020-03-08", "2020-03-10"]
    assert [scan.time - series.scans[0].time for scan in series.scans] == [0, 2]
    for scan, announced in zip(series.scans, (179_757, 261_379), strict=True):
        vertices = np.asarray(read_columns(scan.path).values["y"], np.float64)
        assert len(vertices) == announced
        world = scan.points[:, 1] + scan.origin[1]
        assert set(world.tolist()) <= set(vertices.tolist())  # nothing lost at y near -745
        assert scan.labels.min() == 0


def test_voxel_thins_the_full_resolution(shared_data):
    full = read_series([shared_data / "tomato_fullres"], ReadOptions())
    thin = read_series([shared_data / "tomato_fullres"], ReadOptions(voxel=0.25))
    for before, after in zip(full.scans, thin.scans, strict=True):
        cells = np.column_stack([np.floor(before.points / 0.25), before.labels])
        assert len(after) == len(np.unique(cells, axis=0)) < len(before) / 10
        assert set(after.labels.tolist()) == set(before.labels.tolist())


def test_laz(shared_data):
    path = shared_data / "treeiso_LPine1_demo.laz"
    cloud = choose_fields(read_columns(path), path)
    assert len(cloud) == 1_544_202
    np.testing.assert_allclose(cloud.points.min(axis=0), [-2.12, -2.48, -1.09], atol=1e-6)
    assert not cloud.labels.any()  # never classified; a series of such scans has no labels
