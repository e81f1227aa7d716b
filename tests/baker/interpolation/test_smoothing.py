"""Organs that sway from scan to scan are steadied; those that only grow are left as they are."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from baker import Options, bake
from baker.interpolation.smoothing import local_regression
from grow import plant

OPTIONS = {"align": "none", "up": "z", "labels": "consistent", "even": 0.0}
DAYS = np.array([4.0, 5, 6, 8, 9, 10, 11, 12])


def test_a_straight_course_over_uneven_times_is_kept():
    values = np.outer(DAYS, [1.0, -2.0]) + 3
    assert local_regression(DAYS, values) == pytest.approx(values)


def test_an_outlier_does_not_bend_the_course():
    values = np.outer(DAYS, [1.0])
    values[3] += 50
    assert np.delete(local_regression(DAYS, values), 3) == pytest.approx(
        DAYS[[0, 1, 2, 4, 5, 6, 7]], abs=1
    )


@pytest.fixture(scope="module")
def swaying(tmp_path_factory):
    """A maize whose leaves are turned about their bases at random in every scan."""
    folder, maize = tmp_path_factory.mktemp("swaying"), plant("maize", 1)
    rng = np.random.default_rng(0)
    for day in DAYS:
        cloud = maize.cloud(day, points=3000)
        points = cloud.points.astype(float)
        for organ in maize.organs(day)[1:]:
            turn = Rotation.from_rotvec(rng.normal(0, np.radians(6), 3))
            own, base = cloud.labels == organ.label, np.array(organ.base)
            points[own] = turn.apply(points[own] - base) + base
        np.savetxt(folder / f"day{day:02.0f}.txt", np.c_[points, cloud.labels], fmt="%.4f")
    return maize, folder


@pytest.fixture(scope="module")
def steady(swaying):
    return bake([swaying[1]], Options(smooth=True, **OPTIONS))


def middles(clip):
    """(scans, leaves, 3) where the middles of three leaves are."""
    frames = [clip.at(time) for time in clip.times]
    return np.array([[f.local[f.tracks == n].mean(axis=0) for n in (1, 2, 3)] for f in frames])


def test_steadied_leaves_sway_less_and_are_nearer_to_the_truth(swaying, steady):
    maize, folder = swaying
    before, after = middles(bake([folder], Options(**OPTIONS))), middles(steady)
    clouds = [maize.cloud(day, points=6000, noise=0.0) for day in DAYS]
    truth = np.array([[c.points[c.labels == n].mean(axis=0) for n in (1, 2, 3)] for c in clouds])

    def sway(middle):
        return np.linalg.norm(np.diff(middle - truth, axis=0), axis=2).mean()

    def error(middle):
        return np.linalg.norm(middle - truth, axis=2).mean()

    assert sway(after) < 0.6 * sway(before)
    assert error(after) < 0.9 * error(before)


def test_leaves_stay_attached(steady):
    for time in steady.times:
        frame = steady.at(time)
        stem = frame.local[frame.tracks == 0]
        for label in (1, 2, 3):
            leaf = frame.local[frame.tracks == label]
            assert np.sqrt(((leaf[:, None] - stem[None]) ** 2).sum(2)).min() < 3 * steady.spacing
