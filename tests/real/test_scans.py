"""Real scans of every kind are read whole."""

from functools import cache

import laspy
import numpy as np
import pytest
from plyfile import PlyData
from scipy.spatial import cKDTree

from baker.geometry.neighbors import nearest_neighbors
from baker.options import Options
from baker.scans.fields import choose_fields
from baker.scans.formats import read_columns
from baker.scans.read import read_series
from baker.segmentation.label_cleaning import clean_labels
from tests.real.series import EXAMPLE, GROWN, SHARED, labelled, present

TIMES = {
    GROWN: (0, 3.5, 7, 10.5, 14),
    "maize_control_plant1": range(9),
    "tomato2_control_plant3": range(9),
    "sorghum_control_plant1": range(2, 15, 2),
    "tobacco_heat_plant3": range(0, 9, 2),
    "tomato1_control2_plant1": range(0, 15, 2),
    "unaligned/maize_control_plant1": range(9),
    "unaligned/tomato2_control_plant3": range(9),
    "unaligned/sorghum_control_plant1": range(2, 15, 2),
}
SERIES = [name for name in TIMES if name != GROWN]
PINES = "treeiso_LPine1_demo.laz"
TOMATOES = [EXAMPLE, *(SHARED / name for name in present("tomato_fullres"))]


@cache
def scans_of(folder):
    return read_series([folder])


@pytest.mark.parametrize("name", labelled(*SERIES))
def test_labelled_series(series, name):
    read = scans_of(series(name))
    assert [scan.time for scan in read.scans] == list(TIMES[name])
    for scan in read.scans:
        table = np.loadtxt(scan.path)
        unique = np.unique(table[:, :3].astype(np.float32), axis=0)
        np.testing.assert_array_equal(np.unique(scan.points, axis=0), unique)
        assert len(scan) == len(unique)
        assert set(scan.labels.tolist()) <= set(table[:, 3].astype(int).tolist())
        assert scan.origin.tolist() == [0, 0, 0]


@pytest.mark.parametrize("name", labelled(*(name for name in SERIES if "/" not in name)))
def test_labels_of_careful_hands_are_hardly_touched(series, name):
    for scan in scans_of(series(name)).scans:
        cleaned = clean_labels(scan.labels, nearest_neighbors(scan.points))
        assert (cleaned != scan.labels).sum() <= 1e-3 * len(scan)


@pytest.mark.parametrize("folder", TOMATOES, ids=lambda folder: folder.name)
def test_nothing_is_lost_far_from_the_origin(folder):
    """At y near -745 mm, where one step of single precision is 0.00006 mm."""
    read = scans_of(folder)
    assert [scan.date for scan in read.scans] == ["2020-03-08", "2020-03-10"]
    assert [scan.time - read.scans[0].time for scan in read.scans] == [0, 2]
    for scan in read.scans:
        vertices = PlyData.read(scan.path)["vertex"]
        there = np.column_stack([vertices[axis] for axis in "xyz"])
        assert len(scan) == len(np.unique(there, axis=0))
        world = scan.points.astype(float) + scan.origin
        assert cKDTree(there).query(world)[0].max() < 1e-5
        assert len(np.unique(world, axis=0)) == len(scan)
        assert (scan.labels is None) == (folder == EXAMPLE)


@pytest.mark.parametrize("folder", TOMATOES, ids=lambda folder: folder.name)
def test_one_point_stays_of_each_voxel_and_organ(folder):
    side = 1.0
    full = scans_of(folder)
    thin = read_series([folder], Options(voxel=side))
    for before, after in zip(full.scans, thin.scans, strict=True):
        labels = np.zeros(len(before)) if before.labels is None else before.labels
        cells = np.column_stack([np.floor(before.points / side), labels])
        assert len(after) == len(np.unique(cells, axis=0)) < len(before) / 5
        if before.labels is not None:
            assert set(after.labels.tolist()) == set(before.labels.tolist())


@pytest.fixture
def laz_files(tmp_path):
    """Path, points, low corner and step: the example as LAZ, and a stand of pines."""
    scan = scans_of(EXAMPLE).scans[0]
    world = scan.points + scan.origin
    header = laspy.LasHeader(point_format=3, version="1.2")
    header.offsets, header.scales = world.min(axis=0), [1e-4] * 3
    laz = laspy.LasData(header)
    laz.x, laz.y, laz.z = world.T
    laz.write(tmp_path / "tomato.laz")
    found = [(tmp_path / "tomato.laz", len(world), world.min(axis=0), 1e-4)]
    if present(PINES):
        found.append((SHARED / PINES, 1_544_202, [-2.12, -2.48, -1.09], 1e-6))
    return found


def test_laz(laz_files):
    for path, count, low, step in laz_files:
        cloud = choose_fields(read_columns(path), path)
        assert len(cloud) == count
        np.testing.assert_allclose(cloud.points.min(axis=0), low, atol=step)
        assert cloud.labels is None
