"""Cleaning drops what it should, keeps the rest as it was, and says how many."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from baker.errors import InputError
from baker.scans.cleaning import (
    _row_bytes,
    downsample,
    downsample_to,
    drop_duplicates,
    drop_non_finite,
    drop_outliers,
    relative_to,
    shared_origin,
)
from baker.scans.scan import Scan

HERE = Path("scan.ply")
lattice = arrays(np.float32, st.tuples(st.integers(1, 30), st.just(3)), elements=st.integers(-2, 2))


def numbered(points, labels=None):
    """A cloud whose colours number its points, to follow them."""
    points = np.asarray(points, np.float32)
    colors = np.repeat(np.arange(len(points), dtype=np.uint8)[:, None], 3, axis=1)
    return Scan(points, None if labels is None else np.asarray(labels, np.int64), colors, path=HERE)


@given(lattice)
def test_duplicates_keep_the_first_of_each_place(points):
    kept = drop_duplicates(numbered(points, np.arange(len(points))))
    first = sorted({tuple(p): i for i, p in reversed(list(enumerate(points.tolist())))}.values())
    assert kept.labels.tolist() == first
    assert kept.colors[:, 0].tolist() == first
    np.testing.assert_array_equal(kept.points, points[first])
    dropped = len(points) - len(first)
    assert kept.notes == () or kept.notes[0].startswith(f"dropped {dropped} point")
    assert bool(kept.notes) == bool(dropped)


def test_minus_zero_is_zero():
    cloud = relative_to(np.zeros(3), numbered([[0.0, 0, 0], [-0.0, 0, -0.0]]))
    assert len(drop_duplicates(cloud)) == 1


def test_non_finite_points_are_dropped_and_counted():
    nan, inf = np.nan, np.inf
    cloud = numbered([[0, 0, nan], [1, 2, 3], [inf, 0, 0], [4, 5, 6], [0, -inf, nan]])
    kept = drop_non_finite(cloud)
    assert kept.colors[:, 0].tolist() == [1, 3]
    assert kept.notes == ("dropped 3 points with coordinates NaN, infinite or beyond 1e+12.",)


def test_nothing_left_names_the_file():
    with pytest.raises(InputError, match=r"scan\.ply': none of its 2 points has finite"):
        drop_non_finite(numbered([[np.nan] * 3] * 2))
    with pytest.raises(InputError, match=r"scan\.ply' holds no points"):
        drop_non_finite(numbered(np.empty((0, 3))))


@given(lattice, st.sampled_from([0.5, 1.0, 1.7, 10.0]), st.booleans())
def test_downsampling_keeps_one_real_point_for_each_voxel_and_label(points, voxel, labelled):
    labels = np.arange(len(points)) % 3 if labelled else None
    kept = downsample(numbered(points, labels), voxel)
    original = kept.colors[:, 0]
    np.testing.assert_array_equal(kept.points, points[original])
    assert (np.diff(original.astype(int)) > 0).all()

    def keys(points, labels):
        cells = np.floor(points.astype(float) / voxel).tolist()
        return [(*cell, 0 if labels is None else labels[i]) for i, cell in enumerate(cells)]

    assert len(set(keys(kept.points, kept.labels))) == len(kept)
    assert set(keys(kept.points, kept.labels)) == set(keys(points, labels))


def test_voxels_finer_than_any_number_keep_all_points():
    points = np.random.default_rng(0).normal(size=(50, 3)) * 1e9
    for voxel in (1e-300, 5e-324):
        assert len(downsample(numbered(points), voxel)) == 50


def test_downsampling_takes_the_point_nearest_the_mean():
    cloud = numbered([[0.1, 0.1, 0.1], [0.5, 0.5, 0.5], [0.8, 0.8, 0.8], [3, 3, 3]])
    assert downsample(cloud, 1.0).colors[:, 0].tolist() == [1, 3]


def test_outliers_go_and_a_plant_stays():
    random = np.random.default_rng(0)
    plant = random.random((500, 3))
    points = np.concatenate([plant, [[5, 5, 5], [-4, 0, 0]]])
    kept = drop_outliers(numbered(points), 6.0)
    np.testing.assert_array_equal(kept.points, plant.astype(np.float32))
    assert kept.notes == ("dropped 2 points as outliers.",)
    assert len(drop_outliers(numbered([[0, 0, 0]]), 2.0)) == 1


def test_points_at_equal_distances_have_no_outliers():
    corners = np.array([[0, 0, 0], [0, 1, 1], [1, 0, 1], [1, 1, 0]])
    assert len(drop_outliers(numbered(corners), 2.0)) == 4


@given(lattice)
def test_equal_rows_have_equal_bytes(points):
    _, first, group = np.unique(_row_bytes(points), return_index=True, return_inverse=True)
    np.testing.assert_array_equal(points[first][group], points)
    _, expected = np.unique(points, axis=0, return_inverse=True)
    pairs = np.unique(np.stack([group, expected.ravel()]), axis=1)
    assert pairs.shape[1] == len(set(pairs[0])) == len(set(pairs[1]))


@given(
    st.floats(1e-3, 1e4),
    st.tuples(*[st.floats(-1e7, 1e7)] * 3),
    st.integers(0, 1000),
)
def test_origin_keeps_every_place_to_a_millionth_of_the_plant(size, place, seed):
    points = np.random.default_rng(seed).random((100, 3)) * size + place
    origin = shared_origin(points)
    local = relative_to(origin, Scan(points))
    assert local.points.dtype == np.float32
    exact = 2e-6 * size + 1e-15 * np.abs(place).max()
    assert np.abs(local.points + origin - points).max() <= exact
    assert local.notes == ()


def test_small_coordinates_stay_as_they_are():
    points = np.random.default_rng(0).normal(size=(100, 3)) * 50 + [0, 0, 100]
    assert shared_origin(points).tolist() == [0, 0, 0]


def test_stray_points_do_not_move_the_origin():
    corner = np.array([364_000.0, 5_620_000.0, 60.0])
    points = np.random.default_rng(0).random((1000, 3)) + corner
    points[0] = 0
    np.testing.assert_allclose(shared_origin(points), corner, atol=1)


def test_a_scan_far_from_the_first_has_its_own_origin():
    points = np.random.default_rng(0).random((100, 3))
    assert relative_to(np.zeros(3), Scan(points + 1)).origin.tolist() == [0, 0, 0]
    assert relative_to(np.zeros(3), Scan(points + 1e6)).origin.tolist() == [1e6, 1e6, 1e6]


def test_resampling_comes_near_the_number_and_evens_the_density():
    rng = np.random.default_rng(0)
    dense, sparse = rng.random((9000, 3)) * [1, 1, 0], rng.random((1000, 3)) * [1, 1, 0] + [1, 0, 0]
    kept = downsample_to(Scan(np.concatenate([dense, sparse])), 800)
    assert len(kept) == pytest.approx(800, rel=0.05)
    share = (kept.points[:, 0] < 1).mean()
    assert 0.45 < share < 0.6
    assert "to keep one for each voxel of 0.0" in kept.notes[-1]


def test_resampling_leaves_small_scans_alone():
    cloud = Scan(np.random.default_rng(0).random((50, 3)))
    assert downsample_to(cloud, 50) is cloud
