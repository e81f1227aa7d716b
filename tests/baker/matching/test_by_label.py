"""Consistent labels: pairs, births, losses, and organs through the series."""

from itertools import pairwise

import numpy as np

from baker.matching.match import chain_matches, match_by_label
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy


def hierarchy(parents: dict[int, int | None]) -> Hierarchy:
    labels = list(parents)
    return Hierarchy(
        segments=tuple(np.array([i]) for i in range(len(labels))),
        labels=tuple(labels),
        parents=tuple(NO_PARENT if p is None else labels.index(p) for p in parents.values()),
        root=0,
    )


SEEDLING = hierarchy({0: None, 1: 0, 2: 0})
GROWN = hierarchy({0: None, 5: 2, 2: 0, 3: 0})  # 1 is lost; 3 and, on 2, 5 are new


def test_match_by_label():
    match = match_by_label(SEEDLING, GROWN)
    named = [(SEEDLING.labels[a], GROWN.labels[b]) for a, b in match.pairs]
    assert named == [(0, 0), (2, 2)]
    assert [GROWN.labels[i] for i in match.births] == [3, 5]  # parents before their children
    assert [SEEDLING.labels[i] for i in match.losses] == [1]


def test_organs_keep_their_number_and_know_their_parent():
    matches = [match_by_label(a, b) for a, b in pairwise([SEEDLING, GROWN, SEEDLING])]
    organs, matches = chain_matches(matches, consistent=True)
    by_label = {organ.label: organ for organ in organs}
    assert len(organs) == 5
    assert organs[0].label == 0
    assert (by_label[1].first, by_label[1].last) == (0, 2)  # lost, then back: the same organ
    assert (by_label[5].first, by_label[5].last) == (1, 1)
    assert organs[by_label[5].parent].label == 2
    assert organs[by_label[3].parent].label == 0
    for match in matches:
        assert all(match.first.organs[a] == match.second.organs[b] for a, b in match.pairs)
    assert matches[0].second is matches[1].first


def test_independent_labels_never_bring_an_organ_back():
    matches = [match_by_label(a, b) for a, b in pairwise([SEEDLING, GROWN, SEEDLING])]
    organs, _ = chain_matches(matches, consistent=False)
    assert sum(organ.label == 1 for organ in organs) == 2
