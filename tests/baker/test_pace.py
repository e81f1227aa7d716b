"""Pace: what comes to rest is beyond the half of its way half-way, what sways is not."""

import numpy as np
import pytest

from baker.match import IntervalOrgans, Match
from baker.pace import MOST, paces
from baker.segment.hierarchy import NO_PARENT, Hierarchy

POINTS = np.random.default_rng(0).random((20, 3))


def found(places: np.ndarray, times, spacing: float = 1e-6) -> list[float]:
    """The paces of an organ whose middle goes through these places, (scans, 3)."""
    clouds = [POINTS - POINTS.mean(axis=0) + place for place in np.asarray(places, float)]
    one = Hierarchy((np.arange(len(POINTS)),), (0,), (NO_PARENT,), 0)
    matches = [Match(one, one, ((0, 0),), (), ()) for _ in clouds[1:]]
    organs = [IntervalOrgans({0: 7}, {0: 7}, {}) for _ in matches]
    return [by_organ.get(7, 0.0) for by_organ in paces(clouds, matches, organs, times, spacing)]


def along(values) -> np.ndarray:
    return np.asarray(values, float)[:, None] * [0.6, 0.0, 0.8]


@pytest.mark.parametrize("rate", [0.2, 0.5, 0.8])
def test_what_comes_to_rest_is_beyond_the_half_of_its_way(rate):
    times = np.arange(6.0)
    truth = (1 - np.exp(-rate / 2)) / (1 - np.exp(-rate))
    ours = np.array(found(along(1 - np.exp(-rate * times)), times)) + 0.5
    np.testing.assert_allclose(ours[1:-1], truth, atol=0.01)
    assert ((ours > 0.5) & (ours <= truth + 0.01)).all()


def test_backwards_is_the_same_way_back():
    places, times = along([0, 5, 8, 9, 9.5]), np.array([0.0, 1, 3, 4, 6])
    there = found(places, times)
    back = found(places[::-1], (6 - times)[::-1])
    np.testing.assert_allclose(back[::-1], -np.array(there), atol=1e-12)


def test_uneven_dates_are_no_change_of_pace():
    times = np.array([0.0, 1, 4, 4.5, 9])
    np.testing.assert_allclose(found(along(3 * times), times), 0, atol=1e-9)


def test_what_sways_goes_evenly():
    angle = np.radians([0, 40, -80, 70, 10])
    ways = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1) * [[5], [4], [3], [2], [1]]
    places = np.cumsum(np.concatenate([np.zeros((1, 3)), ways]), axis=0)
    assert found(places, np.arange(6.0)) == [0.0] * 5


def test_two_scans_tell_nothing():
    assert found(along([0, 1]), [0, 1]) == [0.0]


def test_paths_never_turn_back():
    paced = found(along([0, 1, 1000, 1001, 1001.001]), np.arange(5.0))
    assert np.abs(paced).max() <= MOST


def test_what_no_scan_shows_does_not_count():
    places, times = along([0, 5, 8, 9, 9.5]), np.arange(5.0)
    assert any(found(places, times))
    assert not any(found(places, times, spacing=10.0))


def test_what_stands_still_has_no_pace():
    assert found(along([0, 0, 1, 1]), np.arange(4.0)) == [0.0, 0.0, 0.0]
