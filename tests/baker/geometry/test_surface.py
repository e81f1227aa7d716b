import numpy as np
import pytest

from baker.geometry.neighbors import Neighbors, nearest_neighbors
from baker.geometry.surface import covariances, octahedral, surface_normals


def codes_of(points: np.ndarray, neighbors: Neighbors | None = None) -> np.ndarray:
    neighbors = neighbors or nearest_neighbors(points)
    return surface_normals(points, covariances(points, neighbors), neighbors)


def decoded(codes: np.ndarray) -> np.ndarray:
    """As docs/format.md says."""
    u, v = (codes / 127.5 - 1.0).T
    x, y = (u + v) / 2, (u - v) / 2
    normals = np.column_stack([x, y, 1.0 - np.abs(x) - np.abs(y)])
    return normals / np.linalg.norm(normals, axis=1)[:, None]


def test_codes_hold_any_normal_within_a_degree() -> None:
    normals = np.random.default_rng(0).normal(size=(5000, 3))
    unit = normals / np.linalg.norm(normals, axis=1)[:, None]
    aligned = np.abs((decoded(octahedral(normals)) * unit).sum(axis=1))
    assert np.degrees(np.arccos(np.minimum(aligned, 1.0))).max() < 1.0


def test_normals_of_a_sphere_point_outwards() -> None:
    random = np.random.default_rng(1)
    points = random.normal(size=(4000, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    noisy = points + 0.003 * random.normal(size=points.shape)
    codes = codes_of(noisy)
    angle = np.degrees(np.arccos(np.abs((decoded(codes) * points).sum(axis=1)).clip(0, 1)))
    assert np.quantile(angle, 0.95) < 6.0


def test_normals_of_a_thin_stem_point_outwards() -> None:
    """The radius is the distance of evenly spaced points; a tenth of that is noise."""
    random = np.random.default_rng(4)
    turn, height = random.uniform(0.0, 2.0 * np.pi, 400), random.uniform(0.0, 64.0, 400)
    outwards = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(400)])
    points = outwards + height[:, None] * [0.0, 0.0, 1.0] + random.normal(0.0, 0.1, (400, 3))
    angle = np.degrees(np.arccos(np.abs((decoded(codes_of(points)) * outwards).sum(axis=1))))
    assert np.median(angle) < 30.0
    assert np.quantile(angle, 0.75) < 50.0


def test_points_that_spread_alike_in_all_directions_have_a_vertical_normal() -> None:
    cube = np.array(np.meshgrid([0.0, 1.0], [0.0, 1.0], [0.0, 1.0])).reshape(3, 8).T
    np.testing.assert_array_equal(codes_of(cube), np.tile(octahedral(np.eye(3)[2:]), (8, 1)))


@pytest.mark.parametrize("flatness", [(3.0, 1.0, 0.001), (3.0, 1.0, 0.9), (1.0, 1e-3, 0.0)])
def test_normals_are_the_smallest_eigenvectors(flatness: tuple[float, float, float]) -> None:
    random = np.random.default_rng(2)
    turns = np.linalg.qr(random.normal(size=(50, 3, 3)))[0]
    clouds = (random.normal(size=(50, 11, 3)) * flatness) @ turns.transpose(0, 2, 1)
    everybody = np.array([[*range(k), *range(k + 1, 11)] for k in range(11)], np.int32)
    for cloud in clouds:
        eigenvectors = np.linalg.eigh(np.cov(cloud.T))[1]
        codes = codes_of(cloud, Neighbors(everybody, np.ones((11, 10), np.float32)))
        np.testing.assert_array_equal(codes, np.tile(octahedral(eigenvectors[:, :1].T), (11, 1)))


@pytest.mark.parametrize("axis", np.eye(3))
def test_normals_of_a_line_are_across_it(axis: np.ndarray) -> None:
    line = np.random.default_rng(3).random((20, 1)) * axis
    normals = decoded(codes_of(line))
    np.testing.assert_allclose(normals @ axis, 0, atol=0.01)


def test_fewer_points_than_make_a_plane() -> None:
    two = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    assert codes_of(two).shape == (2, 2)
