"""What is to be transported: every point starts or ends somewhere, buds lie where organs attach."""

import numpy as np
from scipy.spatial.distance import cdist

from baker.geometry.graph import segment_gaps
from baker.matching.match import chain_matches, match_by_label
from baker.segmentation.from_labels import hierarchy_from_labels
from baker.transport.tasks import interval_tasks

STEM = np.linspace([0, 0, 0], [0, 0, 10], 2000)
LEAF = np.linspace([0.01, 0, 7], [4, 0, 9], 300)
LEAFLET = np.linspace([2, 0.01, 8], [2, 3, 8], 100)


def scan(*organs):
    points = np.concatenate([cloud for _, cloud in organs])
    labels = np.repeat([label for label, _ in organs], [len(cloud) for _, cloud in organs])
    return points, hierarchy_from_labels(labels, 0, segment_gaps(points, labels))


def tasks_between(first, second, **options):
    (p, h), (q, g) = first, second
    _, (match,) = chain_matches([match_by_label(h, g)], consistent=True)
    return interval_tasks((p, q), match, **options)


def test_every_point_has_a_task():
    first, second = scan((0, STEM), (1, LEAF)), scan((0, STEM), (2, LEAF))
    tasks = tasks_between(first, second)
    matched_or_lost = [t.start for t in tasks if t.event != "birth"]
    assert np.array_equal(np.sort(np.concatenate(matched_or_lost)), np.arange(len(first[0])))
    ends = np.concatenate([t.end for t in tasks])
    assert np.array_equal(np.sort(ends), np.arange(len(second[0])))
    assert {t.event for t in tasks} == {"match", "birth", "loss"}


def test_a_bud_lies_at_the_attachment_and_has_one_percent_of_the_parent():
    tasks = tasks_between(scan((0, STEM)), scan((0, STEM), (1, LEAF)))
    bud = next(t.origin[1] for t in tasks if t.event == "birth")
    assert len(bud) == 20
    assert np.abs(STEM[bud] - [0, 0, 7]).max() < 0.2


def test_a_whole_new_subtree_unfolds_from_one_bud():
    tasks = tasks_between(scan((0, STEM)), scan((0, STEM), (1, LEAF), (2, LEAFLET)))
    buds = {t.organ: t.origin[1] for t in tasks if t.event == "birth"}
    assert np.array_equal(buds[1], buds[2])
    assert [t.origin[0] for t in tasks if t.event == "birth"] == [0, 0]


def test_a_bud_on_a_small_parent_has_at_least_three_points_or_all():
    tiny = STEM[:300:150]
    tasks = tasks_between(scan((0, tiny)), scan((0, tiny), (1, LEAF)))
    assert len(next(t.origin[1] for t in tasks if t.event == "birth")) == len(tiny)
    tasks = tasks_between(scan((0, STEM[::10])), scan((0, STEM[::10]), (1, LEAF)))
    assert len(next(t.origin[1] for t in tasks if t.event == "birth")) == 3


def test_the_papers_own_buds_are_what_lies_nearest_to_the_new_organ():
    thick = np.random.default_rng(0).normal(size=(6000, 3)) * [0.3, 0.3, 4] + [0, 0, 5]
    tasks = tasks_between(scan((0, thick)), scan((0, thick), (1, LEAF)), paper=True)
    bud = next(t.start for t in tasks if t.event == "birth")
    nearest = np.argsort(cdist(thick, LEAF).min(axis=1), kind="stable")[:60]
    assert np.array_equal(bud, nearest)


def test_the_papers_own_buds_have_ten_points_at_least():
    sparse = scan((0, STEM[::10])), scan((0, STEM[::10]), (1, LEAF))
    tasks = tasks_between(*sparse, paper=True)
    assert len(next(t.start for t in tasks if t.event == "birth")) == 10


def test_a_small_organ_unfolds_from_few_points():
    small = scan((0, STEM)), scan((0, STEM), (1, LEAF[::5]))
    assert len(next(t.origin[1] for t in tasks_between(*small) if t.event == "birth")) == 6
