"""How an organ moves: shapes with known truth, and what must hold of every motion."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from baker.interpolation.interval_job import MIN_ELONGATION
from baker.interpolation.organ_motion import (
    OrganMotion,
    fit_motion,
    growth_share,
    mid_spine,
    unevenness,
)
from baker.interpolation.organ_shapes import OrganShape
from baker.interpolation.spine import fit_spine, path_lengths
from baker.transport.correspondences import largest_entries
from baker.transport.solve import solve
from tests.baker.interpolation.shapes import SHAPES, Array, Shape, sample

POINTS = 1500


def shape_of(points: Array, base: Array) -> OrganShape:
    nearest = int(np.argmin(((points - base) ** 2).sum(axis=1)))
    lengths = path_lengths(points, np.array([nearest]), np.zeros(1))
    return OrganShape(points, fit_spine(points, lengths), points[nearest], lengths)


def clouds(shape: Shape, noise: float = 0.2) -> tuple[Array, Array]:
    return sample(shape, 0.0, POINTS, 1, noise), sample(shape, 1.0, POINTS + 300, 2, noise)


def motion_between(start: Array, end: Array) -> OrganMotion:
    origin = np.zeros(3)
    return fit_motion(shape_of(start[:1000], origin), shape_of(end[:1000], origin))


def error(rebuilt: Array, truth: Array) -> float:
    """Mean distance both ways, in % of the truth's size."""
    rebuilt = rebuilt[np.random.default_rng(0).permutation(len(rebuilt))[:POINTS]]
    there, back = cKDTree(rebuilt).query(truth)[0], cKDTree(truth).query(rebuilt)[0]
    return 50 * float(there.mean() + back.mean()) / float(np.ptp(truth, axis=0).max())


def errors(shape: Shape) -> tuple[float, float, float]:
    """Half-way: of another sample of the truth (the floor), moved straight, and on curves."""
    start, end = clouds(shape)
    rows, columns = largest_entries(solve(start, end), len(start), len(end))
    truth = sample(shape, 0.5, 20_000, 3)
    motion = motion_between(start, end)
    straight = (start[rows] + end[columns]) / 2
    bent = straight + motion.deviation(start[rows])
    return (
        error(sample(shape, 0.5, POINTS, 4, 0.2), truth),
        error(straight, truth),
        error(bent, truth),
    )


@pytest.mark.parametrize("name", ["leaf", "twisting", "compound"])
def test_what_turns_is_nearer_to_the_truth(name: str) -> None:
    floor, straight, bent = errors(SHAPES[name])
    assert straight > floor + 0.2
    assert bent - floor < 0.7 * (straight - floor)


@pytest.mark.parametrize("name", SHAPES)
def test_no_shape_is_worse_off(name: str) -> None:
    floor, straight, bent = errors(SHAPES[name])
    assert bent - floor < straight - floor + 0.02


@pytest.mark.parametrize("name", ["leaf", "twisting", "curling"])
def test_the_spine_keeps_its_length(name: str) -> None:
    before, after = (shape_of(points[:1000], np.zeros(3)) for points in clouds(SHAPES[name]))
    motion = fit_motion(before, after)
    along = before.spine.along
    nodes = [fit_spine(points, along).nodes for points in (motion.sample, motion.deformed)]
    share = growth_share(*nodes, unevenness(motion.sample, motion.deformed))
    spines = nodes[0], mid_spine(*nodes, share), nodes[1]
    start, half, end = (np.linalg.norm(np.diff(spine, axis=0), axis=1) for spine in spines)
    np.testing.assert_allclose(half, half_way(start, end), rtol=1e-9)
    middle = (motion.sample + motion.deformed) / 2 + motion.deviations
    np.testing.assert_allclose(fit_spine(middle, along).nodes, spines[1], atol=0.5)
    assert half.sum() == pytest.approx((start + end).sum() / 2, rel=0.01)


def half_way(before: Array | float, after: Array | float) -> Array | float:
    """How long what was and will be so long is half-way."""
    return ((np.sqrt(before) + np.sqrt(after)) / 2) ** 2


@pytest.mark.parametrize("name", ["leaf", "twisting", "curling", "compound"])
def test_the_deformation_brings_the_start_onto_the_end(name: str) -> None:
    start, end = clouds(SHAPES[name])
    motion = motion_between(start, end)
    size = float(np.ptp(end, axis=0).max())
    assert cKDTree(end).query(motion.deformed)[0].mean() < 0.015 * size


@pytest.mark.parametrize("name", ["leaf", "twisting", "curling"])
def test_the_deformation_keeps_base_at_base_and_tip_at_tip(name: str) -> None:
    start, end = (shape_of(points, np.zeros(3)) for points in clouds(SHAPES[name]))
    motion = fit_motion(start, end)
    nearest = cKDTree(end.points).query(motion.deformed)[1]
    ranks = [a.argsort().argsort() for a in (start.spine.along, end.spine.along[nearest])]
    assert np.corrcoef(ranks)[0, 1] > 0.95


@pytest.mark.parametrize("name", ["leaf", "twisting", "rolling", "curling"])
def test_the_deformation_keeps_both_margins(name: str) -> None:
    """Where a blade rolls by a right angle, it isn't pressed flat with its points in disorder."""
    start, end = clouds(SHAPES[name])
    motion = motion_between(start, end)
    rng = np.random.default_rng(5)
    along, across = rng.uniform(0.1, 0.9, 4000), rng.uniform(-1, 1, 4000)
    before, middle, after = (SHAPES[name](along, across, u) for u in (0.0, 0.5, 1.0))
    width = float(np.ptp(end, axis=0).min())
    found = motion.registered(before, end)[0]
    rebuilt = (before + found) / 2 + motion.deviation(before)
    for points, truth in ((found, after), (rebuilt, middle)):
        assert np.quantile(np.linalg.norm(points - truth, axis=1), 0.9) < 0.15 * width


def test_a_blade_that_rolls_by_a_right_angle_keeps_its_width() -> None:
    """On straight paths, it has 0.7 of it at mid-interval."""
    shape = SHAPES["rolling"]
    start, end = clouds(shape)
    motion = motion_between(start, end)
    along, margins = np.full(2, 0.65), np.array([-0.9, 0.9])
    before, middle = shape(along, margins, 0.0), shape(along, margins, 0.5)
    rebuilt = (before + motion.registered(before, end)[0]) / 2 + motion.deviation(before)
    width, true_width = (float(np.linalg.norm(np.diff(side, axis=0))) for side in (rebuilt, middle))
    assert width > 0.85 * true_width


def test_what_lies_between_two_nodes_stays_between_them() -> None:
    """A stem grows between its two leaves only; without them it would seem to grow evenly."""
    rng = np.random.default_rng(0)
    heights = rng.uniform(0, 100, 700)
    grown = np.interp(heights, [0, 40, 60, 100], [0, 40, 100, 140])
    stems = [np.column_stack([rng.normal(0, 1, (700, 2)), z]) for z in (heights, grown)]
    start, end = (shape_of(points, np.zeros(3)) for points in stems)
    for shape, places in ((start, (40, 60)), (end, (40, 100))):
        nearest = [int(np.abs(shape.points[:, 2] - height).argmin()) for height in places]
        shape.nodes.update(enumerate(nearest))
    height = fit_motion(start, end).registered(*stems)[0][:, 2]
    assert np.abs(height - grown).max() < 8


def test_a_motion_is_the_same_wherever_the_plant_stands() -> None:
    start, end = clouds(SHAPES["leaf"])
    here = motion_between(start, end)
    shift = np.array([300.0, -700.0, 50.0])
    moved = fit_motion(shape_of(start[:1000] + shift, shift), shape_of(end[:1000] + shift, shift))
    np.testing.assert_allclose(moved.deviations, here.deviations, atol=1e-6)


def test_straight_spines_do_not_deviate() -> None:
    nodes = np.outer(np.linspace(0, 1, 11), [10.0, 0.0, 5.0])
    for share in (0.0, 0.5, 1.0):
        half = mid_spine(nodes, 1.5 * nodes, share)
        np.testing.assert_allclose(half, half_way(1.0, 1.5) * nodes, atol=1e-12)


def test_what_grows_much_is_smaller_half_way_than_the_mean() -> None:
    nodes = np.outer(np.linspace(0, 1, 11), [10.0, 0.0, 5.0])
    lengths = [mid_spine(nodes, times * nodes, 0.0)[-1, 0] for times in (1.0, 1.1, 4.0)]
    assert lengths == pytest.approx([10.0, 10.5, 22.5], rel=1e-3)


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_backwards_the_spine_half_way_is_the_same(share: float) -> None:
    rng = np.random.default_rng(0)
    start, end = rng.normal(0, 1, (2, 11, 3)).cumsum(axis=1)
    there, back = mid_spine(start, end, share), mid_spine(end, start, share)
    np.testing.assert_allclose(there, back, atol=1e-12)
    assert growth_share(start, end, 0.05) == growth_share(end, start, 0.05)


def test_a_rod_that_swings_goes_round() -> None:
    along = np.linspace(0, 1, 11)[:, None]
    start, end = along * [10.0, 0.0, 0.0], along * [0.0, 0.0, 10.0]
    tip = mid_spine(start, end, 0.0)[-1]
    np.testing.assert_allclose(tip, [50**0.5, 0.0, 50**0.5])


def test_where_it_grows_it_turns_sooner() -> None:
    along = np.linspace(0, 1, 11)[:, None]
    start, end = along * [10.0, 0.0, 0.0], along * [0.0, 0.0, 30.0]
    even, growing = (mid_spine(start, end, share)[-1] for share in (0.0, 1.0))
    assert np.linalg.norm(even) == pytest.approx(half_way(10, 30)) == np.linalg.norm(growing)
    assert np.arctan2(even[2], even[0]) == pytest.approx(np.pi / 4)
    assert np.arctan2(growing[2], growing[0]) == pytest.approx(np.arctan2(30, 10))


def test_what_turns_right_round_goes_through() -> None:
    along = np.linspace(0, 1, 11)[:, None]
    half = mid_spine(along * [10.0, 0.0, 0.0], along * [-10.0, 0.1, 0.0], 0.0)
    assert np.isfinite(half).all()
    assert np.linalg.norm(half, axis=1).max() < 1.0


def test_a_body_turns_evenly_and_what_stretches_unevenly_does_not() -> None:
    nodes = np.outer(np.linspace(0, 1, 11), [10.0, 0.0, 0.0])
    assert growth_share(nodes, nodes, 0.0) == 0.0
    assert growth_share(nodes, nodes, 0.3) == 1.0


def test_what_trebles_is_a_body_though_it_stretches_less_evenly() -> None:
    nodes = np.outer(np.linspace(0, 1, 11), [10.0, 0.0, 0.0])
    assert growth_share(nodes, nodes, 0.1) == 1.0
    assert growth_share(nodes, 3 * nodes, 0.1) == 0.0
    assert growth_share(nodes, 3 * nodes, 0.3) == 1.0


def test_unevenness_tells_stretching_from_growing() -> None:
    points = np.random.default_rng(0).uniform(0, 10, (1000, 3))
    assert unevenness(points, 3 * points) < 1e-6
    assert unevenness(points, points * [3.0, 1.0, 1.0]) > 0.2


def test_leaves_of_grasses_are_strips() -> None:
    """And broad leaves are not: what grows at its base is told by this."""
    rng = np.random.default_rng(0)
    for width, is_strip in ((1.0, True), (8.0, False)):
        blade = np.column_stack([rng.uniform(0, 20, 900), rng.uniform(-width, width, 900)])
        shape = shape_of(np.pad(blade, ((0, 0), (0, 1))), np.zeros(3))
        assert (shape.elongation > MIN_ELONGATION) == is_strip
