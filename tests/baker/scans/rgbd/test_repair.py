"""The repair: what it finds, what it fills in, and what it leaves alone."""

import numpy as np
import pytest
from numpy.typing import NDArray

from baker.scans.rgbd.depth_repair import repair

GROUND = 500.0
SIZE = (60, 80)
V, U = np.indices(SIZE)


def disc(u: float, v: float, radius: float) -> NDArray[np.bool_]:
    return (U - u) ** 2 + (V - v) ** 2 <= radius**2


def arched() -> NDArray[np.float64]:
    """A tilted, arched surface, 40 mm and more over the ground."""
    return 440.0 + 0.5 * U - 0.3 * V + 0.004 * (U - 40.0) ** 2


def test_a_sound_leaf_keeps_its_shape_up_to_the_rim() -> None:
    inside = disc(40, 30, 20)
    depth = np.where(inside, arched(), GROUND)
    repaired, unknown = repair(depth, inside.astype(int))
    np.testing.assert_array_equal(repaired, np.where(inside, arched(), 0))
    assert not unknown.any()


def test_depth_edges_beside_the_labels_edges_are_put_right() -> None:
    inside, seen = disc(40, 30, 20), disc(42, 31, 20)
    depth = np.where(seen, arched(), GROUND)
    depth[(seen ^ disc(42, 31, 18)) & (U % 3 == 0)] += 12.0
    wrong = inside & (np.abs(depth - arched()) > 2)
    assert wrong.sum() > 100

    repaired, unknown = repair(depth, inside.astype(int))
    assert unknown[wrong].all()
    assert not unknown[~inside].any()
    np.testing.assert_allclose(repaired[inside], arched()[inside], atol=0.5)


def test_each_label_is_repaired_by_itself() -> None:
    upper = disc(30, 30, 14)
    lower = disc(48, 30, 16) & ~upper
    depth = np.where(disc(32, 30, 14), 430.0, np.where(lower | upper, 470.0, GROUND))
    repaired, _ = repair(depth, 1 * upper + 2 * lower)
    np.testing.assert_allclose(repaired[upper], 430.0, atol=0.5)
    np.testing.assert_allclose(repaired[lower], 470.0, atol=0.5)


def test_valid_depth_is_not_touched() -> None:
    rng = np.random.default_rng(0)
    inside = disc(40, 30, 20)
    depth = np.where(inside, arched() + rng.normal(0, 0.5, SIZE), GROUND)
    repaired, unknown = repair(depth, inside.astype(int))
    valid = inside & ~unknown
    np.testing.assert_array_equal(repaired[valid], depth[valid])
    assert unknown.sum() < 0.05 * inside.sum()


def test_noise_raises_the_tolerance() -> None:
    rng = np.random.default_rng(0)
    inside = disc(40, 30, 25)
    depth = np.where(inside, 450.0 + rng.normal(0, 3.0, SIZE), GROUND)
    assert repair(depth, inside.astype(int))[1].sum() < 0.05 * inside.sum()


def test_unknown_depth_is_filled_and_nothing_else() -> None:
    inside = disc(40, 30, 20)
    depth = np.where(inside, arched(), GROUND)
    missing = disc(40, 30, 3) | disc(44, 33, 4)
    depth[missing] = 0
    repaired, unknown = repair(depth, inside.astype(int))
    np.testing.assert_allclose(repaired[inside], arched()[inside], atol=0.05)
    np.testing.assert_array_equal(unknown, missing)


def test_a_thin_stalk_keeps_its_depth() -> None:
    stalk = (np.abs(V - 30) <= 1) & (U > 10) & (U < 70)
    depth = np.where(stalk, arched(), GROUND)
    repaired, _ = repair(depth, stalk.astype(int))
    np.testing.assert_allclose(repaired[stalk], arched()[stalk], atol=0.5)


def test_parts_without_any_valid_depth_are_dropped() -> None:
    leaf, apart = disc(25, 30, 15), disc(60, 30, 5)
    depth = np.where(leaf, 450.0, 0.0)
    repaired, _ = repair(depth, (leaf | apart).astype(int))
    assert (repaired[apart] == 0).all()
    assert (repaired[leaf] > 0).all()
    alone, unknown = repair(depth, 1 * leaf + 2 * apart)
    assert (alone[apart] == 0).all()
    np.testing.assert_array_equal(unknown, apart)


def test_the_edge_of_the_picture_is_no_border() -> None:
    depth = np.where(U == 0, 440.0, 450.0)
    assert not repair(depth, np.full(SIZE, 5))[1].any()
    _, unknown = repair(np.where(U == 39, 440.0, depth), np.where(U < 40, 1, 0))
    assert set(U[unknown]) == {38, 39}  # a jump, and what is beside it


def test_the_background_may_have_any_number() -> None:
    inside = disc(40, 30, 20)
    depth = np.where(inside, 450.0, GROUND)
    repaired, _ = repair(depth, np.where(inside, 0, 255), background=255)
    np.testing.assert_array_equal(repaired > 0, inside)
    assert not repair(depth, np.full(SIZE, 255), background=255)[0].any()


@pytest.mark.parametrize("count", [1, 4, 20])
def test_labels_of_a_few_pixels(count: int) -> None:
    inside = (V == 30) & (U // count == 40 // count)
    repaired, _ = repair(np.where(inside, 450.0, GROUND), inside.astype(int))
    np.testing.assert_allclose(repaired[inside], 450.0, atol=1e-6)


def test_what_is_filled_lies_between_the_valid_depths_of_its_label() -> None:
    rng = np.random.default_rng(1)
    labels = np.where(U < 40, 1, 2)
    missing = rng.random(SIZE) < 0.3
    depth = np.where(missing, 0.0, 400.0 + 0.5 * rng.random(SIZE) + 10 * labels)
    repaired, unknown = repair(depth, labels)
    assert unknown[missing].all()
    for label in (1, 2):
        assert np.ptp(repaired[labels == label]) < 0.6
    np.testing.assert_array_equal(repaired[~unknown], depth[~unknown])
