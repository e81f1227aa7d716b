"""The nearest neighbors of every point are those that all distances tell, however points lie."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.distance import cdist

from baker.geometry.neighbors import (
    BLOCK_SIZE,
    nearest_neighbors,
    point_spacing,
)
from baker.geometry.parallel import thread_map
from baker.geometry.surface import covariances, point_area

RNG = np.random.default_rng(3)
SHEET = RNG.random((900, 3)) * [10.0, 10.0, 0.01]
CLOUDS = {
    "filled": RNG.random((900, 3)),
    "sheet": SHEET,
    "thin and thick": np.concatenate([SHEET, 0.01 * SHEET, 20.0 * SHEET]),
    "far off": np.concatenate([SHEET, [[1e9, 0.0, 0.0], [-1e12, 1e12, 0.0], [1e12, 1e12, 1e12]]]),
    "in one place": np.concatenate([SHEET, np.full((100, 3), 5.0)]),
    "all in one place": np.zeros((40, 3)),
    "two": np.eye(3)[:2],
    "one": np.ones((1, 3)),
}


def sheet(count):
    return np.c_[np.random.default_rng(0).uniform(0, 1, (count, 2)), np.zeros(count)]


def twig(count, radius):
    """The skin of a rod one long."""
    rng = np.random.default_rng(0)
    turn = rng.uniform(0, 2 * np.pi, count)
    return np.c_[rng.uniform(0, 1, count), radius * np.cos(turn), radius * np.sin(turn)]


def area(points):
    neighbors = nearest_neighbors(points)
    return point_area(covariances(points, neighbors), neighbors)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("name", CLOUDS)
def test_the_nearest_others_are_found(name, dtype):
    points = CLOUDS[name].astype(dtype)
    found = nearest_neighbors(points, 8)
    between = cdist(points, points)
    np.fill_diagonal(between, np.inf)
    k = min(8, len(points) - 1)
    assert found.indices.shape == found.distances.shape == (len(points), k)
    np.testing.assert_allclose(found.distances, np.sort(between, axis=1)[:, :k], rtol=1e-6)
    np.testing.assert_allclose(
        between[np.arange(len(points))[:, None], found.indices], found.distances, rtol=1e-6
    )
    assert all(len(set(row)) == k for row in found.indices.tolist())


@given(arrays(np.float32, st.tuples(st.integers(1, 40), st.just(3)), elements=st.integers(-4, 4)))
def test_points_in_one_place_are_not_their_own_neighbors(points):
    found = nearest_neighbors(points, 3)
    assert (found.indices != np.arange(len(points))[:, None]).all()


def test_the_first_neighbors_do_not_keep_the_others_in_memory():
    found = nearest_neighbors(np.random.default_rng(0).random((50, 3)), 5)
    nearest = found.first(1)
    assert np.array_equal(nearest.indices, found.indices[:, :1])
    assert nearest.spacing == found.spacing
    assert not np.shares_memory(nearest.distances, found.distances)


@pytest.mark.parametrize("count", [2, 100, 50_000])
def test_spacing_of_points_on_a_line(count):
    points = np.zeros((count, 3))
    points[:, 1] = 0.25 * np.arange(count)
    assert point_spacing(points) == pytest.approx(0.25)


def test_degenerate_clouds_have_no_spacing():
    assert point_spacing(np.zeros((1, 3))) == 0.0
    assert point_spacing(np.zeros((0, 3))) == 0.0
    assert nearest_neighbors(np.zeros((1, 3))).spacing == 0.0


def test_lonely_points_are_outliers():
    cloud = np.random.default_rng(0).random((300, 3))
    inliers = nearest_neighbors(np.vstack([cloud, [[50.0, 0, 0]]])).inliers
    assert not inliers[-1]
    assert inliers[:-1].all()


@pytest.mark.parametrize("count", [1, 2, 3])
def test_of_few_points_all_are_inliers(count):
    assert nearest_neighbors(np.eye(3)[:count]).inliers.all()


def test_on_a_sheet_the_area_is_the_square_of_the_distance_to_the_last_neighbor():
    points = sheet(2000)
    square = nearest_neighbors(points).distances[:, -1].astype(float) ** 2
    assert np.isclose(area(points), square).mean() > 0.6
    assert (area(points) <= square * (1 + 1e-9)).all()


@pytest.mark.parametrize("radius", [0.002, 0.004])
def test_a_twig_thinner_than_its_spacing_has_less_area_the_thinner_it_is(radius):
    thin, half = (np.median(area(twig(100, r))) for r in (radius, radius / 2))
    assert half == pytest.approx(thin / 2, rel=0.2)
    assert thin < 0.5 * np.median(nearest_neighbors(twig(100, radius)).distances[:, -1]) ** 2


def test_area_grows_with_the_square_of_the_unit_in_any_order():
    points = np.concatenate([sheet(300), np.add(twig(60, 0.003), [0, 0, 1])])
    order = np.random.default_rng(1).permutation(len(points))
    np.testing.assert_allclose(area(1000 * points), 1e6 * area(points), rtol=1e-5)
    np.testing.assert_allclose(area(points[order]), area(points)[order], rtol=1e-5)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_few_points_have_some_area(count):
    assert np.isfinite(area(np.eye(3)[:count])).all()


def test_area_follows_the_spacing_and_outliers_do_not_stand_out():
    far = [[100.0, 100.0, 100.0]]
    found = area(np.concatenate([sheet(2000), np.add(sheet(500), [5, 0, 0]), far]))
    assert np.median(found[2000:2500]) == pytest.approx(4 * np.median(found[:2000]), rel=0.2)
    assert found[-1] <= found[:-1].max()


def test_threads_find_the_same_neighbors() -> None:
    points = np.random.default_rng(2).random((3 * BLOCK_SIZE + 7, 3))
    points[::50] = points[3]
    serial = nearest_neighbors(points)
    with thread_map(3) as threads:
        parallel = nearest_neighbors(points, map=threads)
    np.testing.assert_array_equal(parallel.indices, serial.indices)
    np.testing.assert_array_equal(parallel.distances, serial.distances)


def test_points_at_random_have_about_the_even_spacing_of_a_grid():
    x, y = np.meshgrid(np.arange(40.0), np.arange(40.0))
    grid = nearest_neighbors(np.column_stack([x.ravel(), y.ravel(), np.zeros(1600)]))
    scattered = nearest_neighbors(sheet(1600) * 40.0)
    assert np.median(grid.even_spacings) == grid.spacing == 1.0
    assert scattered.spacing < 0.55
    assert np.median(scattered.even_spacings) == pytest.approx(0.69, rel=0.05)


def test_a_single_point_has_no_spacing():
    alone = nearest_neighbors(np.ones((1, 3)))
    assert alone.even_spacings.tolist() == [alone.spacing] == [0.0]
    assert alone.inliers.all()
