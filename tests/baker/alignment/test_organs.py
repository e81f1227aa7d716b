"""Organs are what stands out from the way to the base, and their turns are told one by one."""

import numpy as np
import pytest

from baker.alignment.organs import AXIS, peaks_apart
from baker.alignment.pose import Stand, possible_stands
from baker.alignment.turns import organ_turns, organ_yaw
from baker.geometry.sampling import even_sample
from baker.geometry.up_axis import Vertical


def standing(cloud: np.ndarray) -> Stand:
    return possible_stands(even_sample(cloud), Vertical.named("z"), np.zeros(3))[0]


def chain(heights: list[float]) -> list[np.ndarray]:
    last = len(heights) - 1
    return [
        np.array([near for near in (at - 1, at + 1) if 0 <= near <= last]) for at in range(last + 1)
    ]


def test_two_peaks_meet_at_their_pass():
    heights = [0.0, 3.0, 5.0, 2.0, 4.0, 1.0]
    assert peaks_apart(np.array(heights), chain(heights), 1.0).tolist() == [-1, 0, 0, -1, 1, -1]


def test_a_small_peak_is_part_of_the_greater():
    heights = [0.0, 3.0, 5.0, 3.5, 4.0, 1.0]
    numbers = peaks_apart(np.array(heights), chain(heights), 1.0)
    assert numbers.tolist() == [0] * 6


def test_a_third_peak_joins_the_axis_of_two():
    heights = [0.0, 2.0, 1.0, 5.0, 3.0, 6.0, 0.5]
    numbers = peaks_apart(np.array(heights), chain(heights), 0.5)
    assert numbers.tolist() == [-1, 2, -1, 0, -1, 1, -1] or set(numbers[[1, 3, 5]]) == {0, 1, 2}
    assert (numbers[[0, 2, 4, 6]] == AXIS).all()


def test_each_leaf_is_an_organ(days):
    organs = standing(days[0]).organs
    azimuths = np.degrees(np.arctan2(organs.centers[:, 1], organs.centers[:, 0])) % 360.0
    lever = np.hypot(*organs.centers[:, :2].T)
    assert np.allclose(np.sort(azimuths[lever > 4.0]), [20.0, 110.0, 170.0, 300.0], atol=4.0)


def test_a_bare_stem_is_one_organ():
    stem = standing(np.outer(np.linspace(0.0, 10.0, 200), [0.0, 0.0, 1.0]))
    assert set(stem.organs.numbers) == {0}


@pytest.mark.parametrize("count", [1, 2, 3])
def test_next_to_no_points_have_no_organs(count):
    assert standing(np.eye(3)[:count]).organs.centers.shape == (0, 3)


def test_turns_are_told_leaf_by_leaf(plant):
    before, after = standing(plant(0)), standing(plant(1, turned={2: -30.0}))
    turns, levers, share = organ_turns(before, after, 0.0)
    assert len(turns) >= 4
    assert np.isclose(turns, -30.0, atol=5.0).sum() == 1
    assert (np.abs(turns[levers > 4.0]) < 3.0).sum() == 3
    assert 0.5 < share <= 1.0


def test_a_leaf_that_turns_does_not_turn_the_plant(plant):
    before, after = standing(plant(0)), standing(plant(1, turned={2: -30.0}))
    assert abs(organ_yaw(before, after, 4.0)) < 1.0
