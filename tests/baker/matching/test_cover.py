"""Organs numbered anew in every scan are recognised by what they cover."""

import numpy as np
import pytest

from baker.matching.pieces import agreement, consistent_pieces
from baker.matching.tracking import track_organs


def growing_plant(day: int, rng: np.random.Generator):
    """A stem and up to five straight leaves, each longer every day; leaf k is born on day k - 1."""
    organs = [np.linspace([0, 0, 0], [0, 0, 10 + day], 300)]
    for leaf in range(5):
        if day >= leaf - 1:
            age = day - leaf + 2
            azimuth = 2.4 * leaf
            reach = np.array([np.cos(azimuth), np.sin(azimuth), 0.4])
            base = np.array([0.05, 0, 2 + 2 * leaf])
            organs.append(base + np.linspace(0, 1.2 * age, 100)[:, None] * reach)
    points = np.concatenate(organs) + rng.normal(0, 0.02, (sum(map(len, organs)), 3))
    return points, np.repeat(np.arange(len(organs)), [len(organ) for organ in organs])


@pytest.fixture
def series():
    rng = np.random.default_rng(3)
    scans = [growing_plant(day, rng) for day in range(5)]
    return [points for points, _ in scans], [labels for _, labels in scans]


def test_shuffled_labels_are_named_again(series):
    clouds, truth = series
    rng = np.random.default_rng(1)
    shuffled = [rng.permutation(labels.max() + 1)[labels] * 7 - 3 for labels in truth]
    named = track_organs(clouds, shuffled, [0] * len(clouds))
    for labels, names in zip(truth, named, strict=True):
        for organ in np.unique(labels):
            assert len(np.unique(names[labels == organ])) == 1
    first_name = {}
    for labels, names in zip(truth, named, strict=True):
        for organ in np.unique(labels):
            name = names[labels == organ][0]
            assert first_name.setdefault(organ, name) == name
    assert len(set(first_name.values())) == len(first_name)


def test_agreement_tells_names_from_numbers(series):
    clouds, truth = series
    bases = [0] * len(clouds)
    assert agreement(clouds, truth, bases) == 1.0
    turned = [(labels + k) % (labels.max() + 1) for k, labels in enumerate(truth)]
    assert agreement(clouds, turned, bases) < 0.5
    nothing_shared = [labels + 100 * k for k, labels in enumerate(truth)]
    assert agreement(clouds, nothing_shared, bases) == 0.0


def test_birth_and_loss_in_one_interval(series):
    clouds, truth = series
    keep = truth[1] != 1  # leaf 1 is gone in the second scan, leaf 2 is new in it
    named = track_organs([clouds[0], clouds[1][keep]], [truth[0], truth[1][keep]], [0, 0])
    lost = named[0][truth[0] == 1][0]
    assert lost not in named[1]
    assert named[1].max() == named[0].max() + 1


def test_pieces_of_an_organ_are_neither_born_nor_lost():
    """A stem cut in two in one scan only: the piece too many goes to the stem in that scan."""
    rng = np.random.default_rng(3)
    plants = [growing_plant(day, rng) for day in (3, 4, 5)]
    old = [labels <= 2 for _, labels in plants]  # a bud beside the cut could be taken for a piece
    clouds = [points[kept] for (points, _), kept in zip(plants, old, strict=True)]
    truth = [labels[kept] for (_, labels), kept in zip(plants, old, strict=True)]
    for cut in (0, 1, 2):
        pieces = [labels.copy() for labels in truth]
        upper = (truth[cut] == 0) & (clouds[cut][:, 2] > 7)
        pieces[cut][upper] = 99
        named = consistent_pieces(clouds, pieces, [0] * len(clouds))
        stem = named[cut][(truth[cut] == 0) & ~upper][0]
        assert set(named[cut][upper]) == {stem}
        assert all(set(n[t == 0]) == {stem} for n, t in zip(named, truth, strict=True))


def test_an_organ_born_in_pieces_is_one_when_it_is_seen_whole():
    rng = np.random.default_rng(3)
    plants = [growing_plant(day, rng) for day in (2, 5, 6)]
    old = [labels <= 5 for _, labels in plants]
    clouds = [points[kept] for (points, _), kept in zip(plants, old, strict=True)]
    truth = [labels[kept] for (_, labels), kept in zip(plants, old, strict=True)]
    leaf = truth[1] == 5
    assert not (truth[0] == 5).any()
    pieces = [labels.copy() for labels in truth]
    outer = leaf & (np.linalg.norm(clouds[1][:, :2], axis=1) > 1.7)
    pieces[1][outer] = 99
    named = consistent_pieces(clouds, pieces, [0] * len(clouds))
    (name,) = set(named[2][truth[2] == 5])
    assert set(named[1][leaf]) == {name}
    for organ in range(5):
        assert len({int(n[t == organ][0]) for n, t in zip(named, truth, strict=True)}) == 1


def test_whole_organs_are_never_merged(series):
    clouds, truth = series
    pieces = [labels.copy() for labels in truth]
    pieces[1][(truth[1] == 0) & (clouds[1][:, 2] > 7)] = 99
    named = track_organs(clouds, pieces, [0] * len(clouds))
    assert len(np.unique(named[1])) == len(np.unique(pieces[1]))
