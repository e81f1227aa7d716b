"""Rigid motions are recovered exactly."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from baker.alignment.icp import fit_rigid


def test_a_rigid_motion_is_recovered():
    source = np.random.default_rng(0).normal(size=(40, 3))
    turn = Rotation.from_euler("xyz", [10, 20, 170], degrees=True).as_matrix()
    fit = fit_rigid(source, source @ turn.T + [1.0, 2.0, 3.0])
    np.testing.assert_allclose(fit[:3, :3], turn, atol=1e-12)
    np.testing.assert_allclose(fit[:3, 3], [1.0, 2.0, 3.0])


def test_a_mirror_image_is_not_fitted_by_a_reflection():
    source = np.random.default_rng(0).normal(size=(40, 3))
    fit = fit_rigid(source, source * [1, 1, -1])
    assert np.linalg.det(fit[:3, :3]) == pytest.approx(1.0)


@pytest.mark.parametrize("count", [1, 2, 9])
def test_points_on_a_line_are_moved_rigidly(count):
    source = np.outer(np.arange(count), [1.0, 2.0, 0.0])
    target = source[:, [1, 2, 0]] + 1.0
    fit = fit_rigid(source, target)
    np.testing.assert_allclose(source @ fit[:3, :3].T + fit[:3, 3], target, atol=1e-12)
    np.testing.assert_allclose(fit[:3, :3] @ fit[:3, :3].T, np.eye(3), atol=1e-12)
