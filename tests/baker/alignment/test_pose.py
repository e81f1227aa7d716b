"""Organs are branches of the distance from the base; their turns about the stem are told."""

import numpy as np
import pytest

from baker.alignment.pose import Pose, candidate_poses
from baker.alignment.sample import even_sample
from baker.alignment.yaw import organ_turns, organ_yaw
from baker.geometry.up_axis import Vertical


def standing(cloud: np.ndarray) -> Pose:
    return candidate_poses(even_sample(cloud), Vertical.named("z"), np.zeros(3))[0]


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
