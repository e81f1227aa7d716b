"""How much keeps its direction at a yaw, and which yaws fit a whole series."""

import numpy as np
import pytest

from baker.alignment.pose import Pose, pose_at
from baker.alignment.sample import even_sample
from baker.alignment.yaw import (
    YAWS,
    direction_curve,
    fit_yaws,
    refined_yaw,
    second_yaw,
    wrapped,
)
from baker.geometry.up_axis import Vertical

LABELS = np.repeat([0, 1, 2, 3, 4], [900, 700, 700, 700, 700])


def standing(cloud: np.ndarray, labels: np.ndarray | None = None) -> Pose:
    stem = None if labels is None else int(labels[0])
    return pose_at(even_sample(cloud, labels), np.zeros(3), stem, Vertical.named("z"))


def test_an_unmoved_plant_keeps_all(days):
    curve = direction_curve(standing(days[0]), standing(days[0]), False)
    assert curve[0] == pytest.approx(1.0)
    assert curve[65 // 5] < 0.6


@pytest.mark.parametrize("yaw", [-170.0, -95.0, 3.0, 88.0, 179.0])
@pytest.mark.parametrize("labels", [None, LABELS])
def test_every_yaw_is_found(days, posed, yaw, labels):
    poses = [standing(days[0], labels), standing(posed(days[1], -yaw, (0, 0, 0)), labels)]
    fit = fit_yaws(poses, labels is not None)
    assert fit.by_label == (labels is not None)
    coarse = float(YAWS[fit.yaw_indices[0]])
    assert abs(wrapped(coarse - yaw)) < 10.0
    assert abs(wrapped(refined_yaw(*poses, coarse, fit.by_label) - yaw)) < 2.0


def test_a_leaf_that_turns_does_not_turn_the_plant(plant):
    before, after = standing(plant(0)), standing(plant(1, turned={2: -30.0}))
    assert abs(refined_yaw(before, after, 4.0, False)) < 2.0


def test_free_organs_are_not_paired_with_those_far_above(days):
    before = standing(days[0])
    above = before._replace(centers=before.centers + np.array([0.0, 0.0, 3.0 * before.height]))
    assert direction_curve(before, above, False).max() < 0.1


def test_a_bare_stem_is_not_turned():
    stem = standing(np.outer(np.linspace(0.0, 10.0, 200), [0.0, 0.0, 1.0]))
    assert fit_yaws([stem, stem, stem], False).yaw_indices == [0, 0]
    assert refined_yaw(stem, stem, 0.0, False) == 0.0


def test_a_plant_with_two_equal_sides_is_doubtful(posed):
    rng = np.random.default_rng(0)
    side = np.column_stack(
        [1 + 20 * rng.random(600), rng.normal(0, 2, 600), rng.normal(20, 1, 600)]
    )
    both = standing(np.concatenate([side, posed(side, 180.0, (0, 0, 0))]))
    curve = direction_curve(both, both, False)
    assert abs(abs(second_yaw(curve, 0)) - 180.0) <= 5.0
    assert second_yaw(np.where(YAWS == 0, 1.0, 0.5), 0) is None


def test_labels_are_names_or_numbers(plant):
    rng = np.random.default_rng(0)
    scans = [plant(day) for day in range(4)]
    assert fit_yaws([standing(scan, LABELS) for scan in scans], True).by_label
    anew = [rng.permutation(5)[LABELS] for _ in scans]
    poses = [standing(*scan) for scan in zip(scans, anew, strict=True)]
    assert not fit_yaws(poses, True).by_label
