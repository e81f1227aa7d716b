"""Organs numbered anew in every scan, followed through the whole series."""

import numpy as np
import pytest

from baker.matching.descriptors import describe_organs
from baker.matching.score import match_scores, neighbor_displacements
from baker.matching.tracking import (
    INDIRECT_WEIGHT,
    averaged_penalties,
    chain_organs,
    track_organs,
)
from grow import plant


def whorl(day: int, rng: np.random.Generator):
    """A stem with arched leaves in two opposite rows; the upper ones are born later, one a day."""
    organs = [np.linspace([0, 0, 0], [0, 0, 20 + 4 * day], 300)]
    for leaf in range(2 + day):
        length = 12.0 * min(day - leaf + 3, 4)
        along = np.linspace(0, 1, 150)[:, None] * length
        side = 1.0 if leaf % 2 else -1.0
        base = np.array([0.1 * side, 0.0, 8.0 + 4 * leaf])
        organs.append(base + along * [side, 0.2, 1.0] - along**2 * [0, 0, 0.015])
    labels = np.repeat(np.arange(len(organs)), [len(organ) for organ in organs])
    points = np.concatenate(organs)
    return points + rng.normal(0, 0.05, points.shape), labels


@pytest.fixture
def series():
    rng = np.random.default_rng(5)
    scans = [whorl(day, rng) for day in range(5)]
    return [points for points, _ in scans], [labels for _, labels in scans]


def shuffled(labels, seed=1):
    rng = np.random.default_rng(seed)
    return [rng.permutation(names.max() + 1)[names] for names in labels]


def feet(clouds):
    return [int(np.argmin(cloud[:, 2])) for cloud in clouds]


def assert_same_organs(truth, tracks):
    """One track an organ, one organ a track, over the whole series."""
    pairs = {
        (int(organ), int(track))
        for names, numbers in zip(truth, tracks, strict=True)
        for organ, track in zip(names, numbers, strict=True)
    }
    assert len(pairs) == len({o for o, _ in pairs}) == len({t for _, t in pairs})


def test_leaves_of_a_whorl_keep_their_tracks(series):
    clouds, truth = series
    assert_same_organs(truth, track_organs(clouds, shuffled(truth), feet(clouds)))


def test_backwards_the_same_organs(series):
    clouds, truth = (list(reversed(part)) for part in series)
    assert_same_organs(truth, track_organs(clouds, shuffled(truth), feet(clouds)))


def test_the_up_axis_and_the_unit_do_not_matter(series):
    clouds, truth = series
    turned = [cloud[:, [1, 2, 0]] * 0.001 + 7.0 for cloud in clouds]
    assert_same_organs(truth, track_organs(turned, shuffled(truth), feet(clouds)))


@pytest.mark.parametrize("scans", [(2,), (2, 3)])
def test_an_organ_hidden_in_a_scan_comes_back_as_itself(series, scans):
    clouds, truth = (list(part) for part in series)
    for scan in scans:
        seen = truth[scan] != 1
        clouds[scan], truth[scan] = clouds[scan][seen], truth[scan][seen]
    assert_same_organs(truth, track_organs(clouds, shuffled(truth), feet(clouds)))


def stem_with_leaves(*leaves: tuple[float, float, float]):
    """A stem with straight leaves of an azimuth in degrees, a height and a length each."""
    organs = [np.linspace([0, 0, 0], [0, 0, 20], 200)]
    for azimuth, height, length in leaves:
        direction = np.cos(np.radians(azimuth)), np.sin(np.radians(azimuth)), 0.5
        along = np.linspace(0, length, 80)[:, None]
        organs.append([0.0, 0.0, height] + along * direction)
    labels = np.repeat(np.arange(len(organs)), [len(organ) for organ in organs])
    return np.concatenate(organs), labels


@pytest.mark.parametrize("azimuth", [30, 45, 60])
def test_a_leaf_that_turns_is_not_the_one_that_comes_in_its_place(azimuth):
    others = (100, 8, 14), (250, 12, 14)
    before, after = (0, 15, 3), (azimuth, 15, 3)
    scans = [(*others, before), (*others, after), (*others, after, before)]
    clouds, truth = zip(*(stem_with_leaves(*leaves) for leaves in scans), strict=True)
    assert_same_organs(truth, track_organs(clouds, shuffled(truth), feet(clouds)))


def test_half_a_leaf_is_still_the_leaf(series):
    clouds, truth = (list(part) for part in series)
    reach = np.abs(clouds[2][:, 0])
    seen = (truth[2] != 2) | (reach < np.median(reach[truth[2] == 2]))
    clouds[2], truth[2] = clouds[2][seen], truth[2][seen]
    assert_same_organs(truth, track_organs(clouds, shuffled(truth), feet(clouds)))


def test_numbers_go_by_first_appearance(series):
    clouds, truth = series
    tracks = track_organs(clouds, shuffled(truth), feet(clouds))
    highest = -1
    for numbers in tracks:
        assert numbers.dtype == np.int64
        new = np.unique(numbers[numbers > highest])
        assert np.array_equal(new, np.arange(highest + 1, highest + 1 + len(new)))
        highest = max(highest, int(numbers.max()))


@pytest.mark.parametrize("kind", ["maize", "tomato"])
def test_plants_that_grow(kind):
    subject = plant(kind, 2)
    days = subject.default_days[::2]
    scans = [subject.cloud(day, 4000, colors=False) for day in days]
    clouds, truth = [s.points for s in scans], [s.labels for s in scans]
    tracks = track_organs(clouds, shuffled(truth), feet(clouds))
    right, shared = 0, 0
    for k in range(1, len(days)):
        for organ in np.intersect1d(truth[k - 1], truth[k]):
            before = tracks[k - 1][truth[k - 1] == organ][0]
            right += before == tracks[k][truth[k] == organ][0]
            shared += 1
    assert right / shared >= 0.95


@pytest.mark.parametrize("labels", [[0], [0, 0], [0, 1], [4, 4, 9, 2]])
def test_a_handful_of_points(labels):
    points = np.arange(3.0 * len(labels)).reshape(-1, 3)
    names = np.array(labels)
    tracks = track_organs([points, points, points], [names] * 3, [0, 0, 0])
    assert all(np.array_equal(tracks[0], later) for later in tracks)


def test_worth_is_the_same_both_ways(series):
    clouds, truth = series
    young, old = (describe_organs(clouds[k], truth[k], 0) for k in (1, 3))
    there, back = match_scores(young, old), match_scores(old, young)
    assert np.array_equal(there, back.T)
    assert (there.argmax(axis=1) == np.arange(len(young))).all()


def test_an_organ_that_shrinks_scores_less_than_one_that_stays_or_grows():
    stem = np.linspace([0, 0, 0], [0, 0, 30], 200)

    def scan(length, opposite):
        leaves = [np.linspace([0, 0, 15], [end, 0, 15], 100) for end in (length, -opposite)]
        return describe_organs(
            np.concatenate([stem, *leaves]), np.repeat([0, 1, 2], [200, 100, 100]), 0
        )

    before = scan(10.0, 10.0)
    scores = [match_scores(before, scan(later, 16.0))[1, 1] for later in (6.0, 8.0, 10.0, 16.0)]
    assert scores == sorted(scores)
    assert scores[0] < scores[2] - 0.2


def leaf_direction(azimuth: float, elevation: float) -> np.ndarray:
    """Direction, about the stem, of a leaf with the given angles in degrees."""
    a, e = np.radians([azimuth, elevation])
    base = np.array([0.0, 0.0, 15.0])
    tip = base + 12.0 * np.array([np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), np.sin(e)])
    points = np.concatenate([np.linspace([0, 0, 0], [0, 0, 30], 200), np.linspace(base, tip, 80)])
    return describe_organs(points, np.repeat([0, 1], [200, 80]), 0).about_stem().directions[1]


@pytest.mark.parametrize("degrees", [20, 50, 70])
def test_a_leaf_that_droops_changes_less_than_one_that_turns(degrees):
    before = leaf_direction(0, 0)
    droops, turns = leaf_direction(0, -degrees), leaf_direction(degrees, 0)
    assert np.arccos(before @ droops) < 0.7 * np.arccos(before @ turns)


def test_directions_about_the_stem_follow_the_plant():
    """A plant that lies on the ground has the same directions about its stem."""
    points, labels = whorl(3, np.random.default_rng(0))
    organs, motion = describe_organs(points, labels, 0), np.eye(4)
    motion[:3, :3] = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    fallen = organs.transformed(motion).about_stem().directions
    np.testing.assert_allclose(fallen, organs.about_stem().transformed(motion).directions)
    np.testing.assert_allclose(np.linalg.norm(fallen, axis=1), 1.0)


@pytest.mark.parametrize("ambiguous", [(0, 1), (1, 2)])
def test_scans_two_apart_decide_between_similar_pairs(ambiguous):
    """By the scan after the next one, or by the one before the last one."""
    similar, clear = np.array([[0.50, 0.45], [0.45, 0.50]]), np.array([[0.1, 1.5], [1.5, 0.1]])
    certain = np.array([[0.2, np.inf], [np.inf, 0.2]])
    penalties = {(0, 1): certain, (1, 2): certain, (0, 2): clear, ambiguous: similar}
    averages = averaged_penalties(penalties, [np.array([4, 5])] * 3)
    assert (averages[ambiguous].argmin(axis=1) == [0, 1]).all()
    expected = (0.50 + INDIRECT_WEIGHT * 0.1) / (1.0 + INDIRECT_WEIGHT)
    assert averages[ambiguous][0, 0] == pytest.approx(expected)
    other = (1, 2) if ambiguous == (0, 1) else (0, 1)
    assert np.isinf(averages[other][0, 1])  # impossible pairs stay impossible
    unknown = averaged_penalties(penalties, [np.arange(0)] * 3)
    assert all(np.array_equal(unknown[pair], penalties[pair]) for pair in penalties)


def places(*counts):
    """Of so many organs in each scan, one above the other."""
    return [np.arange(count) for count in counts]


def test_tracks_are_numbered_by_appearance_and_then_along_the_plant():
    worth = {(0, 1): np.array([[-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]])}
    first, second = chain_organs([np.array([9.0, 3.0]), np.array([5.0, 3.0, 1.0])], worth)
    assert (first.tolist(), second.tolist()) == ([1, 0], [2, 1, 0])


def test_a_path_through_a_later_scan_beats_a_poor_successor():
    one, two = np.array([[5.0]]), np.array([[0.0, 5.0]])
    worth = {
        (0, 1): np.array([[1.0]]),
        (1, 2): np.array([[-1.0, 4.0]]),
        (0, 2): np.array([[3.0, -1.0]]),
    }
    assert [t.tolist() for t in chain_organs(places(1, 1, 2), worth)] == [[0], [1], [0, 1]]
    successors = {(0, 1): one, (1, 2): two}
    assert [t.tolist() for t in chain_organs(places(1, 1, 2), successors)] == [[0], [0], [1, 0]]


def test_no_match_is_worth_it():
    never = {(0, 1): np.full((2, 2), -np.inf)}
    assert [t.tolist() for t in chain_organs(places(2, 2), never)] == [[0, 1], [2, 3]]


def test_births_and_losses_in_one_interval():
    worth = {(0, 1): np.array([[2.0, -1.0, -1.0], [-1.0, -1.0, -1.0]])}
    assert [t.tolist() for t in chain_organs(places(2, 3), worth)] == [[0, 1], [0, 2, 3]]


def test_organs_are_ordered_only_along_a_stem_that_carries_many():
    """Two leaves on a stem, with two leaflets on one or on both of them."""
    ends = [([0, 0, 0], [0, 0, 10]), ([0, 0, 5], [9, 0, 5]), ([0, 0, 9], [-9, 0, 9])]
    ends += [([9, 0, 5], [9, y, 7]) for y in (-6, 6)] + [([-9, 0, 9], [-9, y, 9]) for y in (-6, 6)]
    cloud = np.concatenate([np.linspace(a, b, 50) for a, b in ends])
    names = np.repeat(np.arange(len(ends)), 50)
    one_leaf = names <= 4
    order = describe_organs(cloud[one_leaf], names[one_leaf], 0).order
    assert order[2] > order[1]
    assert not describe_organs(cloud, names, 0).order.any()


def compound_leaf(elevation: float, rng: np.random.Generator):
    """A stem with a leaf on top that rises at an angle, in degrees, and seven leaflets on it."""
    along = np.array([np.cos(np.radians(elevation)), 0.0, np.sin(np.radians(elevation))])
    top, height = np.array([0.0, 0.0, 30.0]), np.linspace(0.0, 1.0, 200)[:, None]
    organs = [np.concatenate([height * top, top + 32.0 * height * along])]
    across = np.linspace(0.2, 5.0, 60)[:, None] * [0.0, 1.0, 0.0]
    organs += [top + (5.0 + 4.0 * leaflet) * along + across for leaflet in range(7)]
    labels = np.repeat(np.arange(len(organs)), [len(organ) for organ in organs])
    points = np.concatenate(organs)
    return points + rng.normal(0.0, 0.03, points.shape), labels


def test_leaflets_keep_their_tracks_where_their_leaf_sinks_and_rises():
    rng = np.random.default_rng(5)
    scans = [compound_leaf(elevation, rng) for elevation in (60.0, 40.0, 60.0, 40.0)]
    clouds, truth = ([scan[part] for scan in scans] for part in (0, 1))
    assert_same_organs(truth, track_organs(clouds, shuffled(truth), feet(clouds)))


def test_known_pairs_tell_where_the_others_have_moved():
    """However far they have moved together, and either way round."""
    rng = np.random.default_rng(2)
    cloud, labels = whorl(3, rng)
    young = describe_organs(cloud, labels, 0)
    old = describe_organs(cloud + np.array([30.0, 0.0, 0.0]), labels, 0)
    pairs = [(i, i) for i in range(len(young))]
    apart, together = match_scores(young, old)[2, 2], match_scores(young, old, pairs)[2, 2]
    assert together > apart
    crossed = [*pairs[:-2], (4, 5), (5, 4)]
    assert match_scores(young, old, crossed)[2, 2] == pytest.approx(together, abs=0.1)
    grown = describe_organs(1.5 * cloud, labels, 0)
    there, back = match_scores(young, grown, pairs), match_scores(grown, young, pairs)
    np.testing.assert_allclose(there, back.T)


def test_a_wrong_pair_neither_confirms_itself_nor_misleads_its_neighbors():
    at = np.array([[0.0, 0.0, 0.0], [0, 0, 4], [0, 0, 8], [0, 0, 12], [0, 0, 16]])
    leaves = [point + np.linspace([0, 0, 0], [9, 0, 0], 40) for point in at]
    labels = np.repeat(np.arange(5), 40)
    young = describe_organs(np.concatenate(leaves), labels, 0)
    old = describe_organs(np.concatenate(leaves) + np.array([0, 1, 0]), labels, 0)
    right, wrong = [(i, i) for i in range(5)], [(0, 0), (1, 1), (2, 4), (3, 3)]
    expected = neighbor_displacements(young, old, np.array(right), 5.0)
    misled = neighbor_displacements(young, old, np.array(wrong), 5.0)
    np.testing.assert_allclose(misled, expected, atol=0.3)
