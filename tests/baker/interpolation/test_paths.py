"""Curved paths in whole intervals: what deviations, what is carried along, what stays as it was."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from baker.interpolation.movers import OrganMovers, deviation_of, with_deviations
from baker.interpolation.organ_motion import OrganMotion, fit_motion
from baker.interpolation.organ_shapes import organ_shapes
from baker.matching import Match
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy
from gclip import Motion, SegmentPair
from gclip.pack import Movers
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
def baked() -> tuple[list[np.ndarray], Match, list[OrganMovers], list[OrganMovers]]:
    clouds = [plant(0.0), np.concatenate([plant(1.0), plant(1.0)[-100:] + 1.0])]
    segments = tuple(np.split(np.arange(2 * COUNT + 200), [COUNT, 2 * COUNT, 2 * COUNT + 100]))
    first = Hierarchy(segments[:3], (0, 1, 2), PARENTS[:3], 0, organs=(0, 1, 2))
    second = Hierarchy(segments, (0, 1, 2, 3), PARENTS, 0, organs=(0, 1, 2, 3))
    match = Match(first, second, ((0, 0), (1, 1), (2, 2)), (3,), ())
    tasks = []
    for organ, members in enumerate(segments):
        a = segments[2] if organ == 3 else members
        movers = Movers(Motion.MOVE, (clouds[0][a], clouds[1][members]), np.full(len(a), organ))
        pair = SegmentPair(organ, "match", len(a), len(members), len(a))
        tasks.append(OrganMovers(movers, pair, None, a, members))
    motion, origin = leaf_motion(clouds, match), tasks[1].movers.curve[0]
    deviation = deviation_of(1, motion, origin, clouds[1], match.second)
    bent = [tasks[0], replace(tasks[1], deviation=deviation), *tasks[2:]]
    return clouds, match, tasks, with_deviations(bent, match.second)


def middle(moved: OrganMovers) -> np.ndarray:
    start, control, end = moved.movers.curve
    return start / 4 + control / 2 + end / 4


def chord(moved: OrganMovers) -> np.ndarray:
    return (moved.movers.curve[0] + moved.movers.curve[-1]) / 2


def test_the_stem_stands(baked: tuple) -> None:
    _, _, before, after = baked
    assert after[0] is before[0]


def test_curves_keep_their_ends(baked: tuple) -> None:
    _, _, before, after = baked
    for one, two in zip(before, after, strict=True):
        np.testing.assert_array_equal(one.movers.curve[0], two.movers.curve[0])
        np.testing.assert_array_equal(one.movers.curve[-1], two.movers.curve[-1])


def test_the_leaf_deviates_from_its_base_on(baked: tuple) -> None:
    clouds, _, _, after = baked
    out = np.linalg.norm(middle(after[1]) - chord(after[1]), axis=1)
    base = np.linalg.norm(clouds[0][after[1].start_points], axis=1)
    assert out[base < 5].max() < 1.0
    assert out[base > 55].min() > 3.0


def test_what_the_leaf_bears_is_carried_along(baked: tuple) -> None:
    clouds, _, _, after = baked
    start = clouds[0][after[1].start_points]
    tip = np.argmax(np.linalg.norm(start, axis=1))
    leafs = (middle(after[1]) - chord(after[1]))[tip]
    for moved in after[2:]:
        shift = (middle(moved) - chord(moved)).mean(axis=0)
        np.testing.assert_allclose(shift, leafs, atol=1.5)
