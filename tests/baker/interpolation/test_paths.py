"""Curved paths in whole intervals: what deviations, what is carried along, what stays as it was."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from baker.alignment.keyframes import Keyframe
from baker.interpolation.movers import OrganPaths, child_deviations, organ_movers
from baker.interpolation.organ_motion import OrganMotion, fit_motion
from baker.interpolation.organ_shapes import organ_shapes
from baker.interpolation.packing import Movers
from baker.matching.match import Match
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy
from baker.transport.correspondences import Correspondences
from baker.transport.tasks import Task
from tests.baker.interpolation.shapes import leaf, sample

COUNT = 600
PARENTS = (NO_PARENT, 0, 1, 1)  # a stem, its leaf, what sits on that leaf's tip, what is born there


def plant(u: float) -> np.ndarray:
    """A stem, a leaf that deviations, a small ball on the leaf's tip, and another one."""
    rng = np.random.default_rng(7)
    stem = rng.uniform(0, 1, (COUNT, 3)) * [4.0, 4.0, 150.0] - [4.0, 2.0, 150.0]
    blade = sample(leaf, u, COUNT, 3)
    tip = leaf(np.array([0.98]), np.zeros(1), u)
    return np.concatenate([stem, blade, tip + rng.normal(0, 1, (100, 3))]).astype(np.float32)


def leaf_motion(clouds: list[np.ndarray], match: Match) -> OrganMotion:
    places = {1: np.zeros((1, 3))}
    shapes = [
        organ_shapes(cloud, hierarchy, cloud[np.argmin(cloud[:, 2])], places, [0, 1])
        for cloud, hierarchy in zip(clouds, (match.first, match.second), strict=True)
    ]
    return fit_motion(shapes[0][1], shapes[1][1])


@pytest.fixture(scope="module")
def baked() -> tuple[np.ndarray, list[np.ndarray], Movers]:
    """The first scan, the points of each organ in it, and the movers of all."""
    clouds = [plant(0.0), np.concatenate([plant(1.0), plant(1.0)[-100:] + 1.0])]
    segments = tuple(np.split(np.arange(2 * COUNT + 200), [COUNT, 2 * COUNT, 2 * COUNT + 100]))
    first = Hierarchy(segments[:3], (0, 1, 2), PARENTS[:3], 0, organs=(0, 1, 2))
    second = Hierarchy(segments, (0, 1, 2, 3), PARENTS, 0, organs=(0, 1, 2, 3))
    match = Match(first, second, ((0, 0), (1, 1), (2, 2)), (3,), ())
    motion = leaf_motion(clouds, match)
    starts, organs = [*segments[:3], segments[2]], []
    for organ, (start, end) in enumerate(zip(starts, segments, strict=True)):
        task = Task("birth" if organ == 3 else "match", organ, start, end)
        index = np.arange(len(start))
        organs.append(OrganPaths(task, Correspondences(index, index, 0.0, 0.0, "")))
    carried = child_deviations(1, motion, clouds[1], match.second)
    deviation = motion.deviation(clouds[0][starts[1]])
    organs[1] = replace(organs[1], deviation=deviation, child_deviations=carried)
    frames = (Keyframe(cloud, None) for cloud in clouds)
    (movers,) = organ_movers(organs, *frames, match.second, 1.0)
    return clouds[0], starts, movers


def deviation_of(movers: Movers, organ: int) -> np.ndarray:
    start, control, end = (points[movers.tracks == organ] for points in movers.curve)
    return start / 4 + control / 2 + end / 4 - (start + end) / 2


def test_the_stem_stands(baked: tuple) -> None:
    *_, movers = baked
    np.testing.assert_allclose(deviation_of(movers, 0), 0.0, atol=1e-4)


def test_curves_keep_their_ends(baked: tuple) -> None:
    cloud, starts, movers = baked
    np.testing.assert_array_equal(movers.curve[0], cloud[np.concatenate(starts)])


def test_the_leaf_deviates_from_its_base_on(baked: tuple) -> None:
    cloud, starts, movers = baked
    out = np.linalg.norm(deviation_of(movers, 1), axis=1)
    base = np.linalg.norm(cloud[starts[1]], axis=1)
    assert out[base < 5].max() < 1.0
    assert out[base > 55].min() > 3.0


def test_what_the_leaf_bears_is_carried_along(baked: tuple) -> None:
    cloud, starts, movers = baked
    tip = np.argmax(np.linalg.norm(cloud[starts[1]], axis=1))
    of_tip = deviation_of(movers, 1)[tip]
    for child in (2, 3):
        shift = deviation_of(movers, child).mean(axis=0)
        np.testing.assert_allclose(shift, of_tip, atol=1.5)


def test_an_organ_is_carried_by_all_that_it_grows_on() -> None:
    cloud = np.zeros((3, 3), np.float32)
    scan = Hierarchy(
        tuple(np.arange(3)[:, None]), (0, 1, 2), (NO_PARENT, 0, 1), 0, organs=(0, 1, 2)
    )
    plan = Correspondences(np.zeros(1, int), np.zeros(1, int), 0.0, 0.0, "")
    carried: tuple[dict[int, np.ndarray], ...] = ({1: np.eye(3)[0]}, {2: np.eye(3)[1]}, {})
    organs = [
        OrganPaths(Task("match", organ, points, points), plan, child_deviations=carried[organ])
        for organ, points in enumerate(scan.segments)
    ]
    (movers,) = organ_movers(organs, Keyframe(cloud, None), Keyframe(cloud, None), scan, 0.0)
    shifts = [deviation_of(movers, organ)[0] for organ in range(3)]
    np.testing.assert_allclose(shifts, [(0, 0, 0), (1, 0, 0), (1, 1, 0)])
