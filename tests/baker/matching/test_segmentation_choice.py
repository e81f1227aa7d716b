"""Of several segmentations of a scan, the one that matches those of the adjacent scans."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from baker.alignment.stem_base import base_point
from baker.geometry.up_axis import Vertical
from baker.matching.segmentation_choice import choose_segmentations
from baker.segmentation.organs import candidate_organs
from tests.baker.segmentation.seedling import leaf_on_top, seedling

UP = Vertical.named("z")


def choose(clouds, candidates):
    return choose_segmentations(clouds, [base_point(c, UP) for c in clouds], candidates)


def cut(labels: np.ndarray, cloud: np.ndarray) -> np.ndarray:
    """Another segmentation, with the first blade cut across."""
    own = labels == 1
    away = np.linalg.norm(cloud[:, :2], axis=1)
    return np.where(own & (away > np.median(away[own])), labels.max() + 1, labels)


@pytest.mark.parametrize("wrong_first", [False, True])
@pytest.mark.parametrize("scan", [0, 1, 2])
def test_a_blade_cut_in_one_scan_only_is_not_chosen(scan, wrong_first):
    plants = [seedling(3, size=size) for size in (4.0, 5.0, 6.0)]
    clouds, truths = zip(*plants, strict=True)
    candidates = [[truth] for truth in truths]
    candidates[scan].insert(not wrong_first, cut(truths[scan], clouds[scan]))
    chosen = choose(clouds, candidates)
    assert all(map(np.array_equal, chosen, truths))


def test_a_blade_cut_in_all_other_scans_is_cut():
    clouds, truths = zip(*(seedling(3, size=size) for size in (4.0, 5.0, 6.0)), strict=True)
    cuts = [cut(truth, cloud) for truth, cloud in zip(truths, clouds, strict=True)]
    chosen = choose(clouds, [[cuts[0]], [truths[1], cuts[1]], [cuts[2]]])
    assert all(map(np.array_equal, chosen, cuts))


def test_a_stem_merged_with_a_blade_is_not_chosen_where_the_plant_leans():
    clouds, truths = zip(*(seedling(3, size=size) for size in (4.0, 5.0)), strict=True)
    lean = Rotation.from_euler("x", 60, degrees=True)
    clouds = [clouds[0], lean.apply(clouds[1])]
    bases = [int(np.linalg.norm(cloud, axis=1).argmin()) for cloud in clouds]
    merged = np.where(truths[1] == 3, 0, truths[1])
    chosen = choose_segmentations(clouds, bases, [[truths[0]], [merged, truths[1]]])
    assert np.array_equal(chosen[1], truths[1])


def test_of_equal_segmentations_the_first_is_chosen():
    cloud, truth = seedling(3)
    renumbered = truth + 7
    chosen = choose([cloud, cloud], [[truth, renumbered], [renumbered, truth]])
    assert np.array_equal(chosen[0], truth)
    assert np.array_equal(chosen[1], renumbered)


def test_a_single_scan_keeps_its_first_segmentation():
    cloud, truth = seedling(3)
    (chosen,) = choose([cloud], [[truth, cut(truth, cloud)]])
    assert np.array_equal(chosen, truth)


@pytest.mark.parametrize("order", [1, -1])
def test_the_adjacent_scan_tells_of_a_leaf_that_is_not_plain(order):
    """A short and crumpled leaf, seen only because it is unfolded in another scan."""
    plant, crumpled, unfolded = seedling(2)[0], leaf_on_top(1.4, 1.6, 0.1), leaf_on_top(5, 3, 0.02)
    clouds = [np.vstack([plant, leaf]) for leaf in (crumpled, unfolded)]
    candidates = [candidate_organs(cloud, base_point(cloud, UP)) for cloud in clouds]
    found = choose(clouds[::order], candidates[::order])[::order]
    assert (candidates[0][0][-len(crumpled) :] == 0).mean() > 0.9
    assert (found[0][-len(crumpled) :] != 0).mean() > 0.9
