"""Who grows from whom, as all scans agree on it: a touch in one of them decides nothing."""

import numpy as np

from baker.geometry.graph import segment_gaps
from baker.geometry.neighbors import nearest_neighbors
from baker.segmentation.from_labels import MAX_GAP, labelled_hierarchies, parent_ranks
from baker.segmentation.hierarchy import NO_PARENT

SPACING = 0.05


def rod(start, end):
    count = round(np.linalg.norm(np.subtract(end, start)) / SPACING)
    return np.linspace(start, end, count)


STEM = rod([0, 0, 0], [0, 0, 10])
LEFT = rod([0.06, 0, 4], [3, 0, 6])
RIGHT = rod([-0.08, 0, 6], [-3, 0, 8])
SWUNG = rod([0.08, 0, 6], [3, 0, 6.02])  # its tip lies on the one below, nearer than on the stem
YOUNG = rod([3, 0.04, 6], [4, 0.04, 6])  # lies on the tip of LEFT


def series(*scans):
    clouds = [np.concatenate([points for _, points in organs]) for organs in scans]
    labels = [np.repeat([n for n, _ in o], [len(p) for _, p in o]) for o in scans]
    return clouds, labels


def bearers(scans, same_parents=True, found=False):
    """Of each scan, by label, the label of what bears it."""
    clouds, labels = series(*scans)
    found = labelled_hierarchies(
        clouds,
        labels,
        [0] * len(clouds),
        [nearest_neighbors(cloud) for cloud in clouds],
        consistent=True,
        same_parents=same_parents,
        found=found,
        virtual_root=False,
    )
    return [
        {
            label: None if parent == NO_PARENT else hierarchy.labels[parent]
            for label, parent in zip(hierarchy.labels, hierarchy.parents, strict=True)
        }
        for hierarchy in found
    ]


USUAL = [(0, STEM), (1, LEFT), (2, RIGHT)]
TOUCHING = [(0, STEM), (1, LEFT), (2, SWUNG)]


def test_an_organ_that_touches_another_once_stays_on_its_bearer():
    assert bearers([USUAL, TOUCHING], same_parents=False)[1][2] == 1
    for order in ([USUAL, TOUCHING], [TOUCHING, USUAL], [USUAL, TOUCHING, USUAL]):
        assert all(scan == {0: None, 1: 0, 2: 0} for scan in bearers(order))


def test_organs_that_were_found_by_shape_hang_where_most_paths_enter_them():
    """In every scan the leaf's tip is nearer to another leaf than its base is to the stem."""
    assert bearers([TOUCHING, TOUCHING])[0] == {0: None, 1: 0, 2: 1}
    assert bearers([TOUCHING, TOUCHING], found=True)[0] == {0: None, 1: 0, 2: 0}


def test_nothing_grows_from_what_is_younger():
    # Both are as near each other as the older one is to the stem, or nearer.
    apart = [(0, STEM), (1, np.add(LEFT, [0.06, 0, 0]))]
    found = bearers([apart, [*apart, (2, YOUNG)], [*apart, (2, YOUNG)]])
    assert [scan[1] for scan in found] == [0, 0, 0]
    assert [scan[2] for scan in found[1:]] == [1, 1]


def test_what_comes_up_between_an_organ_and_its_bearer_bears_it_not():
    apart = [(0, STEM), (1, np.add(LEFT, [0.06, 0, 0]))]
    between = (2, rod([0.06, 0, 4], [0.06, 1, 4]))  # nearer to both than they are to each other
    found = bearers([apart, [*apart, between]])
    assert found == [{0: None, 1: 0}, {0: None, 1: 0, 2: 0}]


def test_where_its_bearer_is_hidden_an_organ_hangs_on_what_is_near():
    found = bearers([[*USUAL, (3, YOUNG)], [(0, STEM), (2, RIGHT), (3, YOUNG)]])
    assert found[0][3] == 1
    assert found[1][3] in (0, 2)


def test_scans_that_show_one_of_two_say_nothing_of_how_far_they_are():
    clouds, labels = series(USUAL, USUAL[:2], TOUCHING)
    gaps = list(map(segment_gaps, clouds, labels))
    ranks = parent_ranks(labels, gaps)
    assert ranks[2, 0] == (False, np.mean([gaps[k][2, 0] for k in (0, 2)]))
    assert ranks[2, 1] == (False, np.mean([MAX_GAP, gaps[2][2, 1]]))


def test_the_scans_unit_does_not_matter():
    def ranks(scale):
        clouds, labels = series(USUAL, TOUCHING)
        scaled = [scale * cloud for cloud in clouds]
        return parent_ranks(labels, list(map(segment_gaps, scaled, labels)))

    one, other = ranks(1.0), ranks(1000.0)
    assert one.keys() == other.keys()
    assert np.allclose([one[pair] for pair in one], [other[pair] for pair in one])


def test_an_organ_at_the_plant_base_that_is_not_the_root_grows_from_the_nearest():
    """No path enters it, since all paths start in it."""
    usual, below = [(0, STEM), (1, LEFT)], (2, rod([0, 0, -2], [0, 0, -0.05]))
    assert bearers([usual, usual, [below, *usual]], found=True)[2] == {0: None, 1: 0, 2: 0}
