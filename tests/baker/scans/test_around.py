"""What a scan's points have around them: the same, looked up once or one after another."""

from pathlib import Path

import numpy as np
import pytest

from baker.geometry.spacing import Surroundings, point_spacing
from baker.options import Options
from baker.pipeline import bake_recorded
from baker.scans import ReadOptions, read_series
from baker.scans.around import look_around
from baker.scans.cloud import Cloud
from baker.segmentation.from_labels import touching_segments
from baker.segmentation.series import labelled_hierarchies
from grow import plant
from grow.cli import main as grow


@pytest.fixture(scope="module")
def cloud():
    grown = plant("tomato").cloud(20.0, points=4000)
    return Cloud(grown.points.astype(np.float32), grown.labels)


@pytest.mark.parametrize("workers", [1, 2])
def test_all_is_as_if_looked_up_one_after_another(cloud, workers):
    mended, around = look_around(cloud, workers)
    alone = Surroundings.of(cloud.points, surface=True)
    assert around.spacing == alone.spacing == point_spacing(cloud.points)
    np.testing.assert_array_equal(around.reach, alone.reach)
    np.testing.assert_array_equal(around.surface, alone.surface)
    assert around.touching == touching_segments(cloud.points, mended.labels, around.spacing)
    assert around.touching


def test_what_touches_is_what_touches_with_strays_mended(cloud):
    labels = cloud.labels.copy()
    names, counts = np.unique(labels, return_counts=True)
    largest, *others = names[np.argsort(-counts)]
    touching = look_around(cloud)[1].touching
    apart = largest, next(other for other in others if (largest, other) not in touching)
    inside = np.flatnonzero(labels == largest)[50:52]
    assert len(inside) == 2
    labels[inside] = apart[1]
    mended, around = look_around(Cloud(cloud.points, labels))
    np.testing.assert_array_equal(mended.labels[inside], apart[0])
    assert apart not in around.touching


def test_a_cloud_of_too_many_labels_is_not_searched_for_what_touches():
    points = np.random.default_rng(0).random((2000, 3)).astype(np.float32)
    assert look_around(Cloud(points, np.arange(2000)))[1].touching is None
    assert look_around(Cloud(points))[1].touching is None


def test_scans_are_looked_at_only_where_that_is_asked(tmp_path: Path):
    grow(["maize", str(tmp_path), "--scans", "2", "--points", "600", "-q"])
    asked = read_series([tmp_path], ReadOptions(look_around=True)).scans
    assert all(scan.around is not None and len(scan.around.reach) == len(scan) for scan in asked)
    assert all(scan.around is None for scan in read_series([tmp_path]).scans)


def test_a_bake_hangs_organs_by_what_was_looked_up(tmp_path: Path):
    grow(["tomato", str(tmp_path), "--scans", "3", "--points", "900", "-q"])
    record = bake_recorded([tmp_path], Options(labels="consistent", align="none", up="z"))[1]
    again = labelled_hierarchies(
        [frame.positions for frame in record.keyframes],
        [scan.labels for scan in record.series.scans],
        [int(h.segments[h.root][0]) for h in record.hierarchies],
        consistent=True,
        agreeing=True,
        virtual_root=False,
        spacings=[scan.around.spacing for scan in record.series.scans],
    )
    assert [h.parents for h in record.hierarchies] == [h.parents for h in again]
