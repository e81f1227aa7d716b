"""Shapes of organs: spines from their attachments, and where their children are attached."""

from __future__ import annotations

import numpy as np
import pytest

from baker.interpolation.organ_shapes import organ_shapes
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy


def rod(count: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.column_stack([rng.uniform(0, 100, count), rng.normal(0, 1, (count, 2))])


def test_a_leaf_is_measured_from_its_stem() -> None:
    stem, leaf = rod(500, 0)[:, [2, 1, 0]], rod(300, 1) + np.array([0.0, 0.0, 60.0])
    cloud = np.concatenate([stem, leaf, np.zeros((5, 3))]).astype(np.float32)
    parts = (np.arange(500), np.arange(500, 800), np.arange(800, 805))
    hierarchy = Hierarchy(parts, (0, 1, 2), (NO_PARENT, 0, 0), 0, organs=(10, 11, 12))
    attachments = {11: np.array([[0.0, 0.0, 60.0]]), 12: np.zeros((1, 3))}
    shapes = organ_shapes(cloud, hierarchy, np.zeros(3), attachments, range(3))
    assert set(shapes) == {10, 11}  # too few points have no shape
    np.testing.assert_allclose(shapes[11].spine.nodes[0], [0, 0, 60], atol=4)
    np.testing.assert_allclose(shapes[11].spine.nodes[-1], [98, 0, 60], atol=4)
    assert shapes[10].spine.along[shapes[10].nodes[11]] == pytest.approx(0.61, abs=0.05)
    assert shapes[11].lengths.min() == pytest.approx(60, abs=8)


def test_what_is_attached_nowhere_has_no_shape() -> None:
    cloud = np.concatenate([rod(100, 0), rod(100, 1)]).astype(np.float32)
    parts = np.arange(100), np.arange(100, 200)
    hierarchy = Hierarchy(parts, (0, 1), (NO_PARENT, 0), 0, organs=(0, 1))
    assert set(organ_shapes(cloud, hierarchy, cloud[0], {}, [0, 1])) == {0}


@pytest.mark.parametrize("height", [40.0, 60.0, 90.0])
def test_a_leaf_that_clasps_a_growing_stem_is_measured_from_its_lower_end(height: float) -> None:
    # The lowest quarter of the leaf touches the stem. As the stem grows, a point farther down the
    # leaf comes to each height, so that the contacts nearest to each other are no attachment.
    stem = rod(500, 0)[:, [2, 1, 0]] * (1.0, 1.0, height / 100)
    leaf = 0.6 * rod(400, 1)[:, [2, 1, 0]] + (1.0, 0.0, height / 2)
    leaf[:, 0] += np.maximum(leaf[:, 2] - height / 2 - 15, 0)  # above the sheath, away from it
    contact = leaf[leaf[:, 2] < height / 2 + 15]
    cloud = np.concatenate([stem, leaf])
    parts = np.arange(500), np.arange(500, 900)
    hierarchy = Hierarchy(parts, (0, 1), (NO_PARENT, 0), 0, organs=(0, 1))
    shape = organ_shapes(cloud, hierarchy, np.zeros(3), {1: contact}, range(2))[1]
    assert shape.attachment[2] == pytest.approx(leaf[:, 2].min(), abs=2.0)
    assert shape.lengths.min() == pytest.approx(height / 2, abs=6.0)
    ranks = np.argsort(np.argsort(shape.lengths)), np.argsort(np.argsort(shape.points[:, 2]))
    assert np.corrcoef(ranks)[0, 1] > 0.98
