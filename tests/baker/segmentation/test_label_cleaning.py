"""Specks of another label are relabelled; whatever may be an organ's own stays."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from baker.geometry.neighbors import nearest_neighbors
from baker.options import Options
from baker.pipeline import bake_with_survey
from baker.scans.cleaning import drop_duplicates
from baker.scans.scan import Scan
from baker.segmentation.label_cleaning import clean_labels


def mended(points, labels):
    return clean_labels(labels, nearest_neighbors(points))


@pytest.fixture(scope="module")
def plant() -> tuple[np.ndarray, np.ndarray]:
    """A stem (0) with a level square leaf on either side (1 and 2), 3,000 points."""
    rng = np.random.default_rng(5)
    stem = rng.random((1000, 3)) * [1.0, 1.0, 12.0]
    leaves = [rng.random((1000, 3)) * [8.0, 8.0, 0.1] + [x, -3.5, z] for x, z in ((1, 8), (-8, 11))]
    points = np.concatenate([stem, *leaves]).astype(np.float32)
    return points, np.repeat(np.arange(3, dtype=np.int64), 1000)


@pytest.mark.parametrize("share", [0.002, 0.02])
def test_specks_are_mended(plant, share):
    points, labels = plant
    rng = np.random.default_rng(7)
    noisy = np.where(rng.random(len(labels)) < share, rng.integers(0, 3, len(labels)), labels)
    wrong = (noisy != labels).sum()
    assert wrong
    assert (mended(points, noisy) != labels).sum() <= 0.25 * wrong


def test_clean_labels_stay(plant):
    points, labels = plant
    assert mended(points, labels) is labels


def test_a_piece_that_is_cut_off_but_not_amid_others_stays(plant):
    points, labels = plant
    gap = (labels == 1) & (points[:, 0] > 7.5) & (points[:, 0] < 8.7)
    points, labels = points[~gap], labels[~gap]
    assert 0 < ((labels == 1) & (points[:, 0] > 8.7)).sum() < 50
    np.testing.assert_array_equal(mended(points, labels), labels)


def test_a_small_piece_that_has_more_neighbors_of_its_own_stays(plant):
    """A bud on a leaf, say: it touches the leaf, but does not lie amid it."""
    points, labels = plant
    bud = np.column_stack([np.full(8, 5.0), np.full(8, 0.5), 8.1 + 0.02 * np.arange(8)])
    points = np.concatenate([points, bud]).astype(np.float32)
    labels = np.append(labels, np.zeros(8, np.int64))
    np.testing.assert_array_equal(mended(points, labels), labels)


def test_a_piece_that_only_touches_another_organ_stays(plant):
    points, labels = plant
    gap = (labels == 1) & (points[:, 0] > 7.5) & (points[:, 0] < 8.7)
    twig = np.column_stack([np.linspace(9, 12, 16), np.full(16, 0.5), np.full(16, 8.2)])
    points = np.concatenate([points[~gap], twig]).astype(np.float32)
    labels = np.concatenate([labels[~gap], np.full(16, 3)])
    np.testing.assert_array_equal(mended(points, labels), labels)


def test_a_thin_stem_through_a_leaf_stays_whole():
    rng = np.random.default_rng(1)
    leaf = rng.random((4000, 3)) * [10.0, 10.0, 0.1] - [5.0, 5.0, 0.05]
    stem = np.column_stack([np.zeros((400, 2)), np.linspace(-30.0, 30.0, 400)])
    labels = np.repeat([1, 0], [4000, 400])
    np.testing.assert_array_equal(mended(np.concatenate([leaf, stem]), labels), labels)


def test_a_piece_stays_though_amid_another_organ(plant):
    points, labels = plant
    rng = np.random.default_rng(2)
    patch = rng.random((280, 3)) * [5.0, 5.0, 0.1] + [-6.5, -2.0, 11.0]
    points = np.concatenate([points, patch]).astype(np.float32)
    labels = np.concatenate([labels, np.full(280, 1)])
    assert (mended(points, labels)[3000:] == 1).mean() > 0.75


def test_a_speck_of_several_points_is_mended(plant):
    points, labels = plant
    noisy = labels.copy()
    together = np.argsort(np.linalg.norm(points - [5.0, 0.5, 8.0], axis=1))[:5]
    assert (labels[together] == 1).all()
    noisy[together] = 2
    np.testing.assert_array_equal(mended(points, noisy), labels)


def test_a_point_that_floats_apart_keeps_its_label(plant):
    points, labels = plant
    points = np.concatenate([points, [[40.0, 40.0, 40.0]]]).astype(np.float32)
    labels = np.append(labels, 0)
    np.testing.assert_array_equal(mended(points, labels), labels)


def test_a_small_organ_stays(plant):
    points, labels = plant
    labels = labels.copy()
    labels[np.argsort(np.linalg.norm(points - [0.5, 0.5, 6.0], axis=1))[:5]] = 9
    np.testing.assert_array_equal(mended(points, labels), labels)


def test_labels_that_are_all_strays_stay(plant):
    points, _ = plant
    labels = np.random.default_rng(3).integers(0, 300, len(points))
    np.testing.assert_array_equal(mended(points, labels), labels)


clouds = st.integers(1, 60).flatmap(
    lambda n: st.tuples(
        arrays(np.float32, (n, 3), elements=st.integers(-3, 3)),
        arrays(np.int64, n, elements=st.integers(-2, 3)),
    )
)


@given(clouds)
@example((np.full((2, 3), 3, np.float32), np.zeros(2, np.int64)))  # hashes above 2 ** 63
def test_no_organ_vanishes_or_appears(cloud):
    cloud = drop_duplicates(Scan(*cloud))
    assert {*mended(cloud.points, cloud.labels)} - {-1, -2} == {*cloud.labels} - {-1, -2}


def test_points_without_a_label_get_that_around_them_unless_they_lie_together():
    points = np.stack(np.meshgrid(np.arange(20.0), np.arange(20.0), [0.0]), -1).reshape(-1, 3)
    labels = np.where(points[:, 0] < 10, 3, 5)
    scattered = np.where(np.arange(400) % 7 == 0, -1, labels)
    assert (mended(points, scattered) == labels).mean() > 0.97
    assert -1 not in mended(points, scattered)
    together = np.where(points[:, 1] < 5, -1, labels)
    assert (mended(points, together) == together).mean() > 0.97


def test_the_papers_way_leaves_labels_alone(tmp_path: Path, plant):
    points, labels = plant
    noisy = labels.copy()
    noisy[[1500, 1700, 2500]] = 0
    for day in (0, 1):
        np.savetxt(tmp_path / f"day{day}.txt", np.column_stack([points + 0.01 * day, noisy]))
    for paper, wanted in ((True, noisy), (False, labels)):
        options = Options(paper=paper, align="none", workers=1)
        _, record = bake_with_survey([tmp_path], options)
        assert all((scan.labels == wanted).all() for scan in record.series.scans)
        notes = ["".join(scan.notes) for scan in record.series.scans]
        assert all(("3 points were given the label" in note) != paper for note in notes)
