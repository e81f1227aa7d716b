"""Organs are branches of the distance from the base, or what the labels say."""

import numpy as np
import pytest

from baker.alignment.pose import Pose, pose_at
from baker.alignment.sample import even_sample
from baker.geometry.up_axis import Vertical


def standing(cloud: np.ndarray) -> Pose:
    return pose_at(even_sample(cloud), np.zeros(3), None, Vertical.named("z"))


def test_each_leaf_is_an_organ(days):
    centers = standing(days[0]).centers
    azimuths = np.degrees(np.arctan2(centers[:, 1], centers[:, 0])) % 360.0
    lever = np.hypot(*centers[:, :2].T)
    assert np.allclose(np.sort(azimuths[lever > 4.0]), [20.0, 110.0, 170.0, 300.0], atol=4.0)


def test_each_label_but_the_stem_is_an_organ(days):
    labels = np.repeat([5, 1, 2, 3, 4], [900, 700, 700, 700, 700])
    pose = pose_at(even_sample(days[0], labels), np.zeros(3), 5, Vertical.named("z"))
    azimuths = np.degrees(np.arctan2(pose.centers[:, 1], pose.centers[:, 0])) % 360.0
    assert pose.names.tolist() == [1, 2, 3, 4]
    assert np.allclose(azimuths, [20.0, 110.0, 170.0, 300.0], atol=4.0)


def test_a_bare_stem_is_one_organ():
    stem = standing(np.outer(np.linspace(0.0, 10.0, 200), [0.0, 0.0, 1.0]))
    assert stem.names.tolist() == [0]


@pytest.mark.parametrize("count", [1, 2, 3])
def test_next_to_no_points_have_no_organs(count):
    assert standing(np.eye(3)[:count]).centers.shape == (0, 3)
