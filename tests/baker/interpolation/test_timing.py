"""Timing: what comes to rest is beyond the middle of its path half-way, what sways is not."""

import numpy as np
import pytest

from baker import Options, bake
from baker.interpolation.timing import MAX_OFFSET, Timing, organ_timings
from baker.matching.match import Match
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy

POINTS = np.random.default_rng(0).random((20, 3))


def offsets_of(organs, times, spacing: float = 1e-6) -> list[list[float]]:
    """By organ and interval the offset of its middle.

    organs: the (scans, 3) places that their middles go through.
    """
    count = len(POINTS)
    clouds = [
        np.concatenate([POINTS - POINTS.mean(axis=0) + places[scan] for places in organs])
        for scan in range(len(times))
    ]
    segments = tuple(np.arange(count) + count * n for n in range(len(organs)))
    numbers = tuple(range(len(organs)))
    named = tuple(7 + n for n in numbers)
    hierarchy = Hierarchy(segments, numbers, (NO_PARENT, *numbers[1:]), 0, organs=named)
    matches = [Match(hierarchy, hierarchy, tuple((n, n) for n in numbers), (), ())] * (
        len(times) - 1
    )
    by_interval = organ_timings(clouds, matches, times, spacing)
    return [
        [found[7 + n].offset if 7 + n in found else 0.0 for found in by_interval] for n in numbers
    ]


def found(places: np.ndarray, times, spacing: float = 1e-6) -> list[float]:
    return offsets_of([np.asarray(places, float)], times, spacing)[0]


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


def radial_offsets(sizes) -> list[float]:
    """The offsets of an organ's growth, by interval."""
    shape = POINTS - POINTS.mean(axis=0)
    clouds = [size * shape + [0, 0, 5.0 * k] for k, size in enumerate(sizes)]
    whole = Hierarchy((np.arange(len(shape)),), (0,), (NO_PARENT,), 0, organs=(7,))
    matches = [Match(whole, whole, ((0, 0),), (), ())] * (len(sizes) - 1)
    timings = organ_timings(clouds, matches, np.arange(float(len(sizes))), 1e-6)
    assert all(one[7].offset == pytest.approx(0, abs=1e-9) for one in timings)
    return [one[7].radial_offset for one in timings]


def test_growth_has_a_timing_of_its_own():
    halving = radial_offsets(10 * (1 - 0.5 ** np.arange(1, 5)))
    # Each day half as fast as the day before: 59 % of the way by noon.
    assert halving[1] == pytest.approx((1 - 0.5**0.5) / 0.5 - 0.5, abs=0.01)


def test_at_the_ends_of_a_series_growth_has_been_slow_or_will_be():
    slowing = radial_offsets([1, 3, 4, 4.5])
    # Before the first scan it was no faster than after it; beyond the last one it is slower still.
    assert slowing[0] == pytest.approx(slowing[1] / 2)
    assert slowing[2] == pytest.approx(slowing[1])
    assert slowing[0] > 0
    assert radial_offsets([4.5, 4, 3, 1])[::-1] == pytest.approx([-share for share in slowing])


def test_a_shift_is_that_of_the_middle_and_of_the_rest():
    start = np.zeros((2, 3))
    end = np.array([[2.0, 0, 0], [4.0, 0, 0]])
    timing = Timing(np.array([3.0, 0, 0]), 0.1, 0.2)
    np.testing.assert_allclose(timing.shift(start, end)[:, 0], [0.3 - 0.2, 0.3 + 0.2])


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
    assert np.abs(paced).max() <= MAX_OFFSET


def test_what_no_scan_shows_does_not_count():
    places, times = along([0, 5, 8, 9, 9.5]), np.arange(5.0)
    assert any(found(places, times))
    assert not any(found(places, times, spacing=10.0))


def test_what_stands_still_has_no_pace():
    assert found(along([0, 0, 1, 1]), np.arange(4.0)) == [0.0, 0.0, 0.0]


def test_where_most_organs_sway_none_foretells_its_way():
    calm = along([0, 5, 8, 9])
    swaying = [
        np.array([[0, 0, 0], [1, 1, 0], [2, -1, 0], [3, 1, 0]]) + 10.0 * n for n in (1, 2, 3)
    ]
    times = np.arange(4.0)
    assert all(offsets_of([calm], times)[0])
    assert not any(offsets_of([calm, *swaying], times)[0])


def test_a_clip_shows_it(tmp_path):
    shape = np.random.default_rng(0).random((300, 3))
    for day, height in enumerate([0.0, 4.0, 6.0, 7.0]):
        cloud = np.concatenate([shape * [9.0, 9.0, 0.1], shape + np.array([0, 0, height + 1])])
        table = np.c_[cloud, np.repeat([0, 1], len(shape))]
        np.savetxt(tmp_path / f"day{day}.txt", table, fmt="%.5f %.5f %.5f %d")
    fixed = {"align": "none", "up": "z", "labels": "consistent", "even": 0.0}
    for paths, share in (("curved", 2 - 2**0.5), ("straight", 0.5)):
        frame = bake([tmp_path], Options(paths=paths, **fixed)).at(1.5)
        middle = frame.positions[frame.tracks == 1][:, 2].mean()
        assert middle == pytest.approx(shape[:, 2].mean() + 5 + 2 * share, abs=0.04)
