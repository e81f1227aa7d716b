import numpy as np

from baker.geometry.neighbors import nearest_neighbors
from baker.geometry.normals import octahedral, surface_normals


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
    codes = surface_normals(noisy, nearest_neighbors(noisy))
    angle = np.degrees(np.arccos(np.abs((decoded(codes) * points).sum(axis=1)).clip(0, 1)))
    assert np.quantile(angle, 0.95) < 6.0


def test_fewer_points_than_make_a_plane() -> None:
    two = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    assert surface_normals(two, nearest_neighbors(two)).shape == (2, 2)
