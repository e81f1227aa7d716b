"""What stays at a yaw, and that the best one is found all round the circle."""

import numpy as np
import pytest

from baker.alignment.correspondence import Cylindrical, direction_overlap
from baker.alignment.pose import Pose, candidate_poses
from baker.alignment.sample import even_sample
from baker.alignment.yaw import exact_yaw, likely_yaws, organ_overlap, overlap_near
from baker.geometry.up_axis import Vertical


def standing(cloud: np.ndarray) -> Pose:
    return candidate_poses(even_sample(cloud), Vertical.named("z"), np.zeros(3))[0]


def apart(yaw: float, other: float) -> float:
    return abs((yaw - other + 180.0) % 360.0 - 180.0)


def test_an_unmoved_plant_keeps_all(days):
    around = Cylindrical.about_stem(even_sample(days[0]).points[:150])
    assert direction_overlap(around, around, 0.0, 0.5) == pytest.approx(1.0)
    assert direction_overlap(around, around, 65.0, 0.5) < 0.6
    stand = standing(days[0])
    assert organ_overlap(stand, stand, 0.0) == pytest.approx(1.0)
    assert organ_overlap(stand, stand, 65.0) < 0.6
    assert overlap_near(stand, stand, 5.0) > overlap_near(stand, stand, 65.0)


def test_growth_alone_keeps_nearly_all(days):
    near, grown = (even_sample(days[0]).points[:150] * factor for factor in (1.0, 1.15))
    before, after = (Cylindrical.about_stem(points) for points in (near, grown))
    assert direction_overlap(before, after, 0.0, 0.5) > 0.95


@pytest.mark.parametrize("yaw", [-170.0, -95.0, 3.0, 88.0, 179.0])
def test_every_yaw_is_found(days, posed, yaw):
    earlier, later = standing(days[0]), standing(posed(days[1], -yaw, (0, 0, 0)))
    likely = likely_yaws(earlier, later)
    assert apart(likely[0].yaw, yaw) < 10.0
    assert apart(exact_yaw(earlier, later, likely[0].yaw), yaw) < 1.5


def test_a_bare_stem_is_not_turned():
    stem = standing(np.outer(np.linspace(0.0, 10.0, 200), [0.0, 0.0, 1.0]))
    assert [fit.yaw for fit in likely_yaws(stem, stem)] == [0.0]
    assert exact_yaw(stem, stem, 0.0) == 0.0


def test_a_plant_with_two_equal_sides_is_doubtful(posed):
    rng = np.random.default_rng(0)
    side = np.column_stack(
        [1 + 20 * rng.random(600), rng.normal(0, 2, 600), rng.normal(20, 1, 600)]
    )
    both = standing(np.concatenate([side, posed(side, 180.0, (0, 0, 0))]))
    yaws = sorted(abs(fit.yaw) for fit in likely_yaws(both, both))
    assert yaws == [0.0, 180.0]


def test_where_no_organs_are_told_apart_points_find_the_yaw(posed):
    rng = np.random.default_rng(0)
    disc = rng.uniform(-1.0, 1.0, (4000, 2))
    disc = disc[np.hypot(*disc.T) < 1.0] * [30.0, 18.0]  # one leaf all round the stem
    disc += np.array([2.0, 1.0])
    cap = np.column_stack([disc, rng.normal(20.0, 0.2, len(disc))])
    earlier, later = standing(cap), standing(posed(cap, 6.0, (0, 0, 0)))
    assert abs(exact_yaw(earlier, later, 0.0) + 6.0) < 1.5
