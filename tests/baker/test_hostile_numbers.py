"""Numbers at the edge: ties, no size, no overlap, 1 point to 10,000; every stage on its own."""

import itertools
import warnings

import numpy as np
import pytest

from baker.alignment.register import align
from baker.alignment.stem_base import base_point
from baker.geometry.neighbors import nearest_neighbors
from baker.geometry.surface import covariances, point_area
from baker.geometry.up_axis import Vertical
from baker.interpolation.deformation import register_nonrigid, spine_deformation
from baker.interpolation.movers import mid_area
from baker.interpolation.organ_motion import fit_motion
from baker.interpolation.organ_shapes import OrganShape
from baker.interpolation.packing import Movers
from baker.interpolation.resampling import with_even_density
from baker.interpolation.spine import (
    MIN_POINTS_FOR_SPINE,
    fit_spine,
    path_lengths,
)
from baker.matching.labels import label_agreement
from baker.matching.tracking import track_organs
from baker.transport.correspondences import largest_entries
from baker.transport.problem import TransportOptions
from baker.transport.solve import solve, wasserstein
from gclip import Motion
from tests.baker.hostile_series import ROUGH, SHAPES, Scan
from tests.baker.series import series_of

SOUND = [name for name in SHAPES if name not in ROUGH]
SCALES = [1.0, 2.0**-29, 2.0**39]
EXACT = (TransportOptions(), TransportOptions(power=1))
SINKHORN = (
    TransportOptions("sinkhorn", iterations=200),
    TransportOptions("sinkhorn", power=1, feasible=False, iterations=200),  # the paper's
    TransportOptions("sinkhorn", gamma=1e-6, iterations=100),  # exp(-cost / gamma) is 0
)


@pytest.fixture(autouse=True)
def warnings_are_errors():
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        yield


def cloud(shape: str, count: int = 60, scale: float = 1.0, seed: int = 0) -> np.ndarray:
    return Scan(shape, count, seed, scale=scale).points()


def check_plan(start: np.ndarray, end: np.ndarray, options: TransportOptions) -> None:
    """Every point of both sides moves, and what is told of the plan is finite and true."""
    plan = solve(start, end, options)
    assert np.isfinite(plan.mass).all()
    assert (plan.mass >= 0).all()
    assert np.isfinite([plan.cost, plan.distance, plan.marginal_error]).all()
    rows, columns = largest_entries(plan, len(start), len(end))
    assert set(rows) == set(range(len(start)))
    assert set(columns) == set(range(len(end)))
    if options in EXACT:
        assert plan.marginal_error < 1e-9
        assert not plan.notes


@pytest.mark.parametrize("shape", SOUND)
@pytest.mark.parametrize("options", EXACT + SINKHORN, ids=["2", "1", "sinkhorn", "paper", "gamma"])
def test_transport_between_any_shapes(shape, options):
    for scale, (n, m) in itertools.product(SCALES, ((20, 30), (1, 9))):
        start, end = cloud(shape, n, scale), cloud("plant", m, scale)
        check_plan(start, end, options)
        check_plan(end, start, options)
        check_plan(start, start, options)


@pytest.mark.parametrize("options", [*EXACT, *SINKHORN[:2]], ids=["2", "1", "sinkhorn", "paper"])
@pytest.mark.parametrize(("n", "m"), [(1, 10_000), (10_000, 1), (3, 10_000), (10_000, 2)])
def test_transport_from_one_point_to_thousands(n, m, options):
    check_plan(cloud("plant", n)[:n], cloud("cloud", m), options)
    check_plan(cloud("same point", n), cloud("same point", m), options)


@pytest.mark.parametrize("shape", SOUND)
def test_distances_between_any_shapes(shape):
    for scale in SCALES:
        start, end = cloud(shape, 50, scale), cloud("plant", 400, scale)
        there, back = wasserstein(start, end), wasserstein(end, start)
        assert 0 <= there < np.inf
        assert there == pytest.approx(back, rel=0.1)
        assert wasserstein(start, start) <= 1e-6 * scale


@pytest.mark.parametrize("shape", SOUND)
def test_alignment_of_any_shapes_is_rigid(shape):
    plant = cloud("plant", 64).astype(np.float32)
    for method, count in (("auto", 1), ("auto", 3), ("auto", 40), ("icp", 2), ("icp", 40)):
        other = cloud(shape, count).astype(np.float32)
        found = align(series_of([plant, other, plant]), method)
        for transform in found.transforms:
            turn = transform[:3, :3]
            assert np.isfinite(transform).all()
            np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-6)
            assert np.linalg.det(turn) == pytest.approx(1.0)
        assert len(found.transforms) == len(found.bases) == 3


@pytest.mark.parametrize("shape", SOUND)
def test_areas_and_spacings_are_finite(shape):
    for scale, count in itertools.product(SCALES, (1, 2, 3, 60)):
        points = cloud(shape, count, scale)
        neighbors = nearest_neighbors(points)
        area = point_area(covariances(points, neighbors), neighbors)
        assert area.shape == (len(points),)
        assert np.isfinite(area).all()
        assert (area >= 0).all()
        assert 0 <= neighbors.spacing < np.inf
        assert neighbors.inliers.any()
        assert 0 <= base_point(points, Vertical.named("z")) < len(points)


@pytest.mark.parametrize(
    ("start", "end"), list(itertools.product(["same point", "plant"], repeat=2))
)
@pytest.mark.parametrize("count", [1, 2, 9, 60])
def test_even_density_of_organs_without_area(start, end, count):
    here, there = cloud(start, count), cloud(end, count)
    points = np.arange(min(len(here), len(there)))
    curve = (here[points].astype(np.float32), there[points].astype(np.float32))
    movers = Movers(Motion.MOVE, curve, np.zeros(len(points), int))
    neighbors = nearest_neighbors(here)
    area = point_area(covariances(here, neighbors), neighbors)
    shared = mid_area(area[points], points, np.zeros(len(points)), points)
    for known, growth in itertools.product((shared, np.zeros(len(points))), (0.0, 1.0, 10.0)):
        parts = with_even_density(movers, known, points, points, growth)
        assert len(points) <= sum(map(len, parts)) <= (1 + growth) * len(points) + 1
        assert all(np.isfinite(part.curve).all() for part in parts)
        assert known is shared or parts == [movers]


def test_no_area_is_too_odd_to_be_even():
    """(1 / 49) * 49 is not 1 in floating point."""
    at = np.zeros((1, 3), np.float32)
    movers = Movers(Motion.MOVE, (at, at), np.zeros(1, int))
    only = np.zeros(1, int)
    for area in (49.0, 1e-300, 1e300, 0.0):
        assert with_even_density(movers, np.array([area]), only, only, 0.0) == [movers]


def organ(points: np.ndarray) -> OrganShape:
    lengths = path_lengths(points, np.array([0]), np.zeros(1))
    return OrganShape(points, fit_spine(points, lengths), points[0], lengths)


@pytest.mark.parametrize("shape", SOUND)
def test_spines_and_warps_of_any_shapes_are_finite(shape):
    plant = organ(cloud("plant", 80))
    for count in (1, 2, 64):
        other = organ(cloud(shape, count))
        spine = other.spine
        assert np.isfinite(spine.nodes).all()
        np.testing.assert_allclose(np.linalg.norm(spine.tangents, axis=1), 1.0)
        assert (spine.along >= 0).all()
        assert (spine.along <= 1).all()
        for first, second in ((plant, other), (other, plant), (other, other)):
            carried = spine_deformation(first.points, second.points, first.spine, second.spine)
            assert np.isfinite(register_nonrigid(carried, second.points)).all()
            few = min(len(first.points), len(second.points)) < MIN_POINTS_FOR_SPINE
            if not few:
                motion = fit_motion(first, second)
                assert all(
                    np.isfinite(side).all()
                    for side in motion.registered(first.points, second.points)
                )
                assert np.isfinite(motion.deviation(first.points)).all()


@pytest.mark.parametrize("shape", SOUND)
def test_organs_of_any_shapes_get_one_name_each(shape):
    """One organ of one point, organs all alike, organs in one place."""
    points = cloud(shape, 60).astype(np.float32)
    for labels in (
        np.zeros(len(points), np.int64),
        np.arange(len(points)),
        (np.arange(len(points)) == 0).astype(np.int64),
        np.arange(len(points)) % 3,
    ):
        first, second = track_organs([points, points], [labels, labels], [0, 0])
        for names in (first, second):
            pairs = set(zip(labels.tolist(), names.tolist(), strict=True))
            assert len({own for own, _ in pairs}) == len(pairs)
        assert label_agreement([points, points], [labels, labels], [0, 0]) == 1
