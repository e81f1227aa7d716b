"""Carrying an organ from spine to spine, and drawing it onto its points in the next scan."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from baker.geometry.neighbors import point_spacing
from baker.interpolation.deformation import (
    register_nonrigid,
    spine_deformation,
)
from baker.interpolation.spine import fit_spine, path_lengths
from tests.baker.interpolation.shapes import leaf, sample


def spine_of(points: np.ndarray):
    nearest = np.array([np.argmin((points**2).sum(axis=1))])
    return fit_spine(points, path_lengths(points, nearest, np.zeros(1)))


def test_a_spine_carries_its_points_along() -> None:
    source, target = sample(leaf, 0.0, 700, 1), sample(leaf, 1.0, 700, 2)
    carried = spine_deformation(source, target, spine_of(source), spine_of(target))
    before, after = (cKDTree(target).query(points)[0].mean() for points in (source, carried))
    assert after < 0.2 * before


def test_registration_finds_an_affine_map() -> None:
    """Its least-squares maps hold every affine map, and blends of equal maps are that map."""
    source = sample(leaf, 0.5, 700, 1)
    target = source @ np.diag([1.02, 0.98, 1.01]) + np.array([0.5, -0.3, 0.2])
    found = register_nonrigid(source, target)
    before, after = (np.linalg.norm(x - target, axis=1).mean() for x in (source, found))
    assert after < 0.5 * before
    assert after < point_spacing(source)


def test_registration_of_a_shifted_cloud_in_any_unit_is_the_same() -> None:
    source, target = sample(leaf, 0.0, 300, 1), sample(leaf, 0.2, 300, 2)
    found = register_nonrigid(source, target)
    np.testing.assert_array_equal(register_nonrigid(1024 * source, 1024 * target), 1024 * found)
    np.testing.assert_allclose(register_nonrigid(source + 50, target + 50), found + 50, atol=1e-6)


def test_clouds_without_extent_are_drawn_onto_each_other() -> None:
    found = register_nonrigid(np.ones((50, 3)), np.full((30, 3), 2.0))
    np.testing.assert_allclose(found, 2.0, atol=1e-4)
