"""The repair: what it finds, what it fills in, and what it leaves alone."""

import numpy as np
import pytest
from numpy.typing import NDArray

from baker.scans.rgbd.camera import RepairOptions
from baker.scans.rgbd.depth_repair import (
    JUMP,
    MISSING,
    PAINTED,
    RING,
    VALID,
    Repaired,
    diffuse,
    repair,
)

GROUND = 500.0
SIZE = (60, 80)
V, U = np.indices(SIZE)


def disc(u: float, v: float, radius: float) -> NDArray[np.bool_]:
    return (U - u) ** 2 + (V - v) ** 2 <= radius**2


def unknown(result: Repaired) -> NDArray[np.bool_]:
    return result.reason > VALID


def count(result: Repaired, reason: int) -> int:
    return int((result.reason == reason).sum())


def arched() -> NDArray[np.float64]:
    """A tilted, arched surface, 40 mm and more over the ground."""
    return 440.0 + 0.5 * U - 0.3 * V + 0.004 * (U - 40.0) ** 2


def test_a_sound_leaf_keeps_its_shape_up_to_the_rim() -> None:
    inside = disc(40, 30, 20)
    depth = np.where(inside, arched(), GROUND)
    result = repair(depth, inside.astype(int))
    np.testing.assert_allclose(result.depth[inside], arched()[inside], atol=0.02)
    assert (result.depth[~inside] == 0).all()
    assert set(np.unique(result.reason)) == {VALID, RING}


def test_depth_edges_beside_the_labels_edges_are_put_right() -> None:
    inside, seen = disc(40, 30, 20), disc(42, 31, 20)
    depth = np.where(seen, arched(), GROUND)
    depth[(seen ^ disc(42, 31, 18)) & (U % 3 == 0)] += 12.0
    wrong = inside & (np.abs(depth - arched()) > 2)
    assert wrong.sum() > 100

    result = repair(depth, inside.astype(int))
    assert unknown(result)[wrong].all()
    np.testing.assert_allclose(result.depth[inside], arched()[inside], atol=0.5)


def test_each_label_is_repaired_by_itself() -> None:
    upper = disc(30, 30, 14)
    lower = disc(48, 30, 16) & ~upper
    depth = np.where(disc(32, 30, 14), 430.0, np.where(lower | upper, 470.0, GROUND))
    result = repair(depth, 1 * upper + 2 * lower)
    np.testing.assert_allclose(result.depth[upper], 430.0, atol=0.5)
    np.testing.assert_allclose(result.depth[lower], 470.0, atol=0.5)


def test_valid_depth_is_not_touched() -> None:
    rng = np.random.default_rng(0)
    inside = disc(40, 30, 20)
    depth = np.where(inside, arched() + rng.normal(0, 0.5, SIZE), GROUND)
    result = repair(depth, inside.astype(int))
    valid = inside & ~unknown(result)
    np.testing.assert_array_equal(result.depth[valid], depth[valid])
    assert count(result, JUMP) < 0.01 * inside.sum()


def test_noise_raises_the_tolerance() -> None:
    rng = np.random.default_rng(0)
    inside = disc(40, 30, 25)
    depth = np.where(inside, 450.0 + rng.normal(0, 3.0, SIZE), GROUND)
    assert count(repair(depth, inside.astype(int)), JUMP) < 0.05 * inside.sum()


def test_missing_and_painted_depth_are_filled_and_counted() -> None:
    inside = disc(40, 30, 20)
    depth = np.where(inside, arched(), GROUND)
    missing, painted = disc(40, 30, 3), disc(45, 35, 4)
    depth[missing] = 0
    depth[painted & ~missing] += 1.5  # below what counts as a jump
    result = repair(depth, inside.astype(int), painted=painted)
    np.testing.assert_allclose(result.depth[inside], arched()[inside], atol=0.05)
    assert count(result, MISSING) == missing.sum()
    assert count(result, PAINTED) == (painted & ~missing).sum()
    assert count(result, JUMP) == 0


def test_a_thin_stalk_keeps_its_depth() -> None:
    stalk = (np.abs(V - 30) <= 1) & (U > 10) & (U < 70)
    depth = np.where(stalk, arched(), GROUND)
    result = repair(depth, stalk.astype(int))
    np.testing.assert_allclose(result.depth[stalk], arched()[stalk], atol=0.5)


def test_parts_without_any_valid_depth_are_dropped() -> None:
    leaf, apart = disc(25, 30, 15), disc(60, 30, 5)
    depth = np.where(leaf, 450.0, 0.0)
    result = repair(depth, (leaf | apart).astype(int))
    assert (result.depth[apart] == 0).all()
    assert (result.depth[leaf] > 0).all()
    alone = repair(depth, 1 * leaf + 2 * apart)
    assert (alone.depth[apart] == 0).all()
    assert (alone.reason[apart] == MISSING).all()


def test_the_edge_of_the_picture_is_no_border() -> None:
    result = repair(np.full(SIZE, 450.0), np.full(SIZE, 5))
    assert not unknown(result).any()
    half = np.where(U < 40, 1, 0)
    result = repair(np.where(half == 1, 450.0, GROUND), half)
    assert set(U[unknown(result)]) == {39}


def test_nothing_is_looked_for_where_nothing_should_be() -> None:
    inside = disc(40, 30, 20)
    depth = np.where(disc(43, 30, 20), 450.0, GROUND)
    result = repair(depth, inside.astype(int), options=RepairOptions(ring=0, band=0))
    assert not unknown(result).any()
    np.testing.assert_array_equal(result.depth[inside], depth[inside])


def test_the_background_may_have_any_number() -> None:
    inside = disc(40, 30, 20)
    depth = np.where(inside, 450.0, GROUND)
    result = repair(depth, np.where(inside, 0, 255), background=255)
    assert (result.depth > 0).sum() == inside.sum()
    assert not repair(depth, np.full(SIZE, 255), background=255).depth.any()


@pytest.mark.parametrize("count", [1, 4, 20])
def test_labels_of_a_few_pixels(count: int) -> None:
    inside = (V == 30) & (U // count == 40 // count)
    result = repair(np.where(inside, 450.0, GROUND), inside.astype(int))
    np.testing.assert_allclose(result.depth[inside], 450.0, atol=1e-6)


def test_diffusion_solves_laplaces_equation() -> None:
    harmonic = (U - 30.0) ** 2 - (V - 20.0) ** 2 + 0.5 * U * V
    segment = np.ones(SIZE, int)
    hole = disc(40, 30, 12)
    filled = diffuse(harmonic, ~hole, segment)
    # The five-point stencil is exact for polynomials of second degree.
    np.testing.assert_allclose(filled, harmonic, atol=1e-6)


def test_diffusion_stays_within_its_boundary_values_and_segments() -> None:
    rng = np.random.default_rng(1)
    segment = np.where(U < 40, 1, 2)
    values = rng.random(SIZE) + 10 * segment
    valid = rng.random(SIZE) < 0.3
    filled = diffuse(values, valid, segment)
    for number in (1, 2):
        own = segment == number
        assert filled[own].min() >= values[own & valid].min() - 1e-9
        assert filled[own].max() <= values[own & valid].max() + 1e-9
    np.testing.assert_array_equal(filled[valid], values[valid])
    assert np.isnan(diffuse(values, valid & (segment == 1), segment)[segment == 2]).all()
