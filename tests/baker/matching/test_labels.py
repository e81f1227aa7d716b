"""Labels are taken as names where shapes agree; else organs are followed through the series."""

import numpy as np
import pytest

from baker.errors import InputError
from baker.matching.corrections import PointCorrection
from baker.matching.labels import MIN_AGREEMENT, label_agreement, label_policy, with_tracked_labels
from tests.baker.series import series_of


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


def policy(clouds, labels, requested):
    return label_policy(series_of(clouds, labels), clouds, [0] * len(clouds), requested)


def tracked(clouds, labels, requested="independent", corrections=()):
    """Each point's track, the labels being numbered anew in every scan."""
    use = policy(clouds, labels, requested)
    assert not use.consistent
    use = with_tracked_labels(use, clouds, labels, [0] * len(clouds), corrections)
    assert use.consistent
    assert use.renamed
    return use.labels


def test_shuffled_labels_are_named_again(series):
    clouds, truth = series
    rng = np.random.default_rng(1)
    shuffled = [rng.permutation(labels.max() + 1)[labels] * 7 - 3 for labels in truth]
    named = tracked(clouds, shuffled)
    for labels, names in zip(truth, named, strict=True):
        for organ in np.unique(labels):
            assert len(np.unique(names[labels == organ])) == 1
    first_name = {}
    for labels, names in zip(truth, named, strict=True):
        for organ in np.unique(labels):
            name = names[labels == organ][0]
            assert first_name.setdefault(organ, name) == name
    assert len(set(first_name.values())) == len(first_name)


def test_agreement_is_measured_against_chance(series):
    clouds, truth = series
    bases = [0] * len(clouds)
    assert label_agreement(clouds, truth, bases) == 1.0
    rng = np.random.default_rng(4)
    shuffled = []
    for _ in range(50):
        numbers = [rng.permutation(labels.max() + 1)[labels] for labels in truth]
        shuffled.append(label_agreement(clouds, numbers, bases))
        stem_first = [np.where(truth[k] == 0, -1, numbers[k]) for k in range(len(truth))]
        shuffled.append(label_agreement(clouds, stem_first, bases))
    assert abs(np.mean(shuffled)) < 0.1
    assert np.quantile(shuffled, 0.9) < MIN_AGREEMENT
    nothing_shared = [labels + 100 * k for k, labels in enumerate(truth)]
    assert label_agreement(clouds, nothing_shared, bases) == 0.0
    assert label_agreement(clouds, [0 * labels for labels in truth], bases) == 1.0


def test_one_wrong_scan_does_not_outvote_the_others(series):
    clouds, truth = series
    numbers = [truth[0], truth[1], np.array([2, 0, 1, 3, 4, 5])[truth[2]], *truth[3:]]
    assert policy(clouds, numbers, "auto").consistent


def test_scans_without_labels_get_those_of_their_tracks(series):
    clouds, truth = series
    bases, numbers = [0] * len(clouds), [labels * 10 for labels in truth]
    given = [numbers[0], None, numbers[2], None, numbers[4]]
    use = policy(clouds, given, "auto")
    assert use.consistent
    assert "found by shape in 2 of 5 scans" in use.findings[0].sentence
    own = [given[k] if given[k] is not None else truth[k] + 7 for k in range(5)]
    use = with_tracked_labels(use, clouds, own, bases)
    assert not use.renamed
    for labels, wanted in zip(use.available, numbers, strict=True):
        np.testing.assert_array_equal(labels, wanted)


def test_birth_and_loss_in_one_interval(series):
    clouds, truth = series
    keep = truth[1] != 1  # leaf 1 is gone in the second scan, leaf 2 is new in it
    named = tracked([clouds[0], clouds[1][keep]], [truth[0], truth[1][keep]])
    lost = named[0][truth[0] == 1][0]
    assert lost not in named[1]
    assert named[1].max() == named[0].max() + 1


def test_an_organ_that_one_scan_cuts_in_two_is_one_organ(series):
    clouds, truth = series
    pieces = [labels.copy() for labels in truth]
    pieces[3][(truth[3] == 0) & (clouds[3][:, 2] > 7)] = 99
    named = tracked(clouds, pieces)
    assert len(np.unique(named[3][truth[3] == 0])) == 1
    assert np.unique(named[3]).tolist() == np.unique(tracked(clouds, truth)[3]).tolist()


def test_parts_that_were_cut_by_hand_or_found_by_shape_stay_apart(series):
    clouds, truth = series
    pieces = [labels.copy() for labels in truth]
    pieces[3][(truth[3] == 0) & (clouds[3][:, 2] > 7)] = 99
    top = int(np.flatnonzero(pieces[3] == 99)[0])
    cut = PointCorrection("Correction 1 (cut)", "cut", ((3, top),))
    for named in (
        tracked(clouds, pieces, corrections=[cut]),
        tracked(clouds, pieces, requested="ignore"),
    ):
        assert len(np.unique(named[3])) == len(np.unique(pieces[3]))


def test_the_policy_says_why(series):
    clouds, truth = series
    assert policy(clouds, truth, "auto").consistent
    turned = [(labels + k) % (labels.max() + 1) for k, labels in enumerate(truth)]
    assert not policy(clouds, turned, "auto").consistent
    assert policy(clouds, turned, "consistent").consistent
    assert not policy(clouds, truth, "ignore").available
    assert not policy(clouds, [None] * 5, "auto").available
    with pytest.raises(InputError, match="have no labels"):
        policy(clouds, [None] * 5, "consistent")
    many, points = [np.arange(1001)] * 5, [np.eye(3)[np.zeros(1001, int)]] * 5
    with pytest.raises(InputError, match="different labels"):
        policy(points, many, "auto")
