"""The skeleton: an even sample, its level sets, loops cut and holes closed."""

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from baker.segmentation.organ_classification import blade_scores, flatness
from baker.segmentation.organs import merge_specks, merge_strips
from baker.segmentation.reeb_graph import reeb_tree, sample_plant, section_widths
from tests.baker.segmentation.seedling import seedling, tube


def sample_of(points: np.ndarray):
    return sample_plant(points, int(np.argmin(points[:, 2])))


def test_the_stem_is_measured():
    for factor in (0.2, 1.0, 30.0):
        points, _ = seedling(density=60)
        assert sample_of(points * factor).diameter == pytest.approx(factor, rel=0.25)


def test_every_point_of_the_cloud_goes_to_its_nearest():
    points, _ = seedling()
    sample = sample_of(points)
    assert np.array_equal(sample.nearest, cKDTree(sample.points).query(points)[1])


def test_distances_never_undercut_the_straight_way():
    points, _ = seedling()
    sample = sample_of(points)
    base = sample.points[np.argmin(sample.distance)]
    straight = np.linalg.norm(sample.points - base, axis=1)
    assert (sample.distance >= straight * (1 - 1e-6)).all()


def test_nodes_form_a_tree_and_hold_every_point_once():
    points, _ = seedling()
    sample = sample_of(points)
    tree = reeb_tree(sample)
    assert tree.parent[0] == -1
    assert all(0 <= parent < node for node, parent in enumerate(tree.parent) if node)
    assert tree.subtree_sums(np.bincount(tree.node))[0] == len(sample.points)
    for node, children in enumerate(tree.children):
        assert all(tree.parent[child] == node for child in children)


def test_a_hole_in_the_stem_makes_no_branches():
    rng = np.random.default_rng(0)
    stem = tube([0, 0, 0], [0, 0, 20], 1.0, 60, rng)
    hole = (abs(stem[:, 2] - 10) < 0.5) & (stem[:, 0] > 0)
    sample = sample_of(stem[~hole])
    tree = reeb_tree(sample)
    beside = [sorted(tree.tip_distance[children])[:-1] for children in tree.children if children]
    assert max(map(max, filter(None, beside)), default=0.0) < 1.5 * sample.diameter


@pytest.mark.parametrize("reach", [1.0, 4.0])
def test_leaves_that_touch_stay_two(reach):
    """Two arms that meet at their tips: a loop too long for a hole is cut where they meet."""
    rng = np.random.default_rng(0)
    stem, top = tube([0, 0, 0], [0, 0, 8], 1.0, 60, rng), 8 + 2 * reach
    arms = [
        tube(*ends, 0.2 * reach, 60, rng)
        for side in (-1, 1)
        for ends in (
            ([0.2 * side, 0, 8], [reach * side, 0, 8 + reach]),
            ([reach * side, 0, 8 + reach], [0.05 * side, 0, top]),
        )
    ]
    sample = sample_of(np.vstack([stem, *arms]))
    tree = reeb_tree(sample)
    branch = np.zeros(len(tree.parent), int)
    for node, parent in enumerate(tree.parent):
        beside = tree.children[parent] if parent >= 0 else []
        arms = [child for child in beside if tree.tip_distance[child] > reach]
        branch[node] = node if node in arms and len(arms) > 1 else branch[max(parent, 0)]
    high = (sample.points[:, 2] > 8 + 0.5 * reach) & (sample.points[:, 2] < top - 0.25 * reach)
    left, right = (branch[tree.node][high & (s * sample.points[:, 0] > 0)] for s in (-1, 1))
    values = np.unique(left)
    assert len(values) == 1
    assert values[0] not in right
    tips = (sample.points[:, 2] > top - 0.25 * reach) & (abs(sample.points[:, 0]) > 0.125 * reach)
    sides = [tree.node[tips & (side * sample.points[:, 0] > 0)] for side in (-1, 1)]
    assert not np.intersect1d(*sides).size


def test_flatness_tells_rod_from_sheet():
    points, truth = seedling(density=80)
    sample = sample_of(points)
    label = truth[cKDTree(points).query(sample.points)[1]]
    ratio = flatness(sample)
    assert np.median(ratio[label == 0]) > 0.6
    assert np.median(ratio[label > 0]) < 0.3


def test_a_blade_too_crumpled_to_be_flat_is_still_wide():
    differences = []
    for seed in range(6):
        points, truth = seedling(2, density=120, seed=seed)
        crumpled = 0.4 * np.random.default_rng(1 + seed).normal(size=points.shape)
        points = points + np.where(truth[:, None] > 0, crumpled, 0.0)
        sample = sample_of(points)
        is_blade = truth[cKDTree(points).query(sample.points)[1]] > 0
        ratio, scores = flatness(sample), blade_scores(sample, reeb_tree(sample))
        assert ratio[is_blade].mean() > ratio[~is_blade].mean()
        differences.append(scores[is_blade].mean() - scores[~is_blade].mean())
    assert np.mean(differences) > 0.0


def test_even_samples_need_fewer_neighbors_than_points_at_random():
    rng = np.random.default_rng(0)
    turn, along = np.meshgrid(np.arange(20) * np.pi / 10, np.arange(160) * np.pi / 20)
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=-1) * 0.5
    even = np.concatenate([ring, along[..., None]], axis=-1).reshape(-1, 3)
    even += rng.normal(0, 0.02, even.shape)
    samples = [sample_of(even), sample_of(tube([0, 0, 0], [0, 0, 25], 1.0, 40, rng))]
    edges = [sample.sparse_graph.nnz / sample.graph.nnz for sample in samples]
    assert edges[0] < 0.75
    assert edges[1] > 0.9


def test_strips_of_a_sheet_are_joined_and_leaves_are_not():
    points, truth = seedling(density=60)
    sample = sample_of(points)
    label = truth[cKDTree(points).query(sample.points)[1]]
    assert np.array_equal(merge_strips(sample, label), label)
    own = np.flatnonzero(label == 1)
    middle = sample.points[own] - sample.points[own].mean(axis=0)
    across = np.linalg.svd(middle, full_matrices=False)[2][1]
    strip = label.copy()
    strip[own[abs(middle @ across - 0.4) < 0.35]] = 4
    assert (strip == 4).any()
    assert not (merge_strips(sample, strip) == 4).any()


def test_a_piece_of_a_margin_is_joined_although_it_is_short():
    """Less than the base of an organ, at which it may touch its parent."""
    points, truth = seedling(density=12.0)
    sample = sample_of(points)
    label = truth[cKDTree(points).query(sample.points)[1]]
    blade = np.flatnonzero(label == 1)
    distance = sample.distance[blade]
    beyond = distance - np.median(distance)
    middle = sample.points[blade] - sample.points[blade].mean(axis=0)
    across = middle @ np.linalg.svd(middle, full_matrices=False)[2][1]
    is_margin = (abs(beyond) < sample.thickness) & (across > np.quantile(across, 0.8))
    piece = label.copy()
    piece[blade[is_margin]] = 4
    assert (piece == 4).sum() >= 5
    assert np.array_equal(merge_strips(sample, piece), label)


def test_specks_are_joined_to_the_organ_that_they_grow_from():
    points, truth = seedling(density=60)
    sample = sample_of(points)
    label = truth[cKDTree(points).query(sample.points)[1]]
    assert np.array_equal(merge_specks(sample, label), label)
    x, _, z = sample.points.T
    speck = label.copy()
    stem_side = (label == 0) & (x < -0.2) & (abs(z - 1.5) < 1.2)  # a strip of the stem
    leaf_base = np.flatnonzero(label == 2)
    leaf_base = leaf_base[np.argsort(sample.distance[leaf_base])[:40]]
    tip = np.flatnonzero(label == 1)
    tip = tip[np.argsort(-sample.distance[tip])[:40]]
    speck[stem_side], speck[leaf_base], speck[tip] = 4, 5, 6
    expected = label.copy()
    expected[leaf_base] = 0  # they grow from the petiole
    assert np.array_equal(merge_specks(sample, speck), expected)


def test_a_twig_is_no_speck():
    points, _ = seedling(density=60)
    away = np.array([-1.0, 0.0, 0.0])
    rng = np.random.default_rng(0)
    twig = tube(0.4 * away + [0, 0, 3], 2.2 * away + [0, 0, 3], 0.5, 60, rng)
    sample = sample_of(np.concatenate([points, twig]))
    x, _, z = sample.points.T
    label = ((x < -0.6) & (abs(z - 3.0) < 0.4)).astype(np.intp)
    assert np.array_equal(merge_specks(sample, label), label)


def test_sections_are_as_wide_as_they_are_across_the_gradient_of_the_distance():
    rng = np.random.default_rng(0)
    angle, along = rng.uniform(0.0, 2.0 * np.pi, 4000), rng.uniform(0.0, 9.0, 4000)
    section = (along / 3.0).astype(np.intp)
    radius = 1.0 + section
    stem = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), along])
    turned = Rotation.from_euler("xyz", [20.0, 50.0, -30.0], degrees=True).apply(stem)
    widths = section_widths(turned + 7.0, along, section)
    np.testing.assert_allclose(widths, [2.0, 4.0, 6.0], rtol=0.02)
