"""Spines: lengths along an organ, and the curve through its level sets."""

from __future__ import annotations

import numpy as np
import pytest

from baker.interpolation.spine import (
    NODE_POSITIONS,
    NODES,
    fit_spine,
    interpolate_nodes,
    path_lengths,
)


def rod(count: int = 400, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.column_stack([rng.uniform(0, 100, count), rng.normal(0, 1, (count, 2))])


def test_lengths_are_measured_along_the_organ() -> None:
    angle = np.linspace(0, np.pi, 300)
    arch = 50 * np.column_stack([np.cos(angle), 0 * angle, np.sin(angle)])
    lengths = path_lengths(arch, np.array([0]), np.zeros(1))
    np.testing.assert_allclose(lengths, 50 * angle, atol=0.1)


def test_parts_that_are_apart_are_reached_across_the_gap() -> None:
    points = np.concatenate([rod(), rod(seed=1) + np.array([150.0, 0.0, 0.0])])
    lengths = path_lengths(points, np.array([np.argmin(points[:, 0])]), np.zeros(1))
    assert np.isfinite(lengths).all()
    assert lengths.max() == pytest.approx(250, rel=0.1)


def test_points_that_coincide_are_no_gap() -> None:
    points = np.repeat(rod(60), 3, axis=0)
    assert np.isfinite(path_lengths(points, np.array([0]), np.zeros(1))).all()


def test_a_rods_spine_is_its_axis_to_the_ends() -> None:
    points = rod(2000)
    spine = fit_spine(points, points[:, 0] - points[:, 0].min())
    assert spine.nodes.shape == (NODES, 3)
    np.testing.assert_allclose(spine.nodes[:, 0], 98 * NODE_POSITIONS, atol=1.5)
    assert np.abs(spine.nodes[:, 1:]).max() < 0.5
    assert (spine.tangents[:, 0] > 0.99).all()


def test_values_at_levels_are_read_between_them() -> None:
    values = np.column_stack([NODE_POSITIONS, 2 * NODE_POSITIONS, 0 * NODE_POSITIONS])
    np.testing.assert_allclose(interpolate_nodes(values, np.array([0.33]))[0], [0.33, 0.66, 0.0])
