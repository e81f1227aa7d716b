"""Masses that both clouds have: whole, of equal sums, small where one cloud has nothing."""

import numpy as np
import pytest

from baker.transport.problem import MIN_SHARE, TOTAL_MASS, TransportOptions, overlap_masses
from baker.transport.solve import solve


@pytest.mark.parametrize(
    ("n", "m"), [(1, 1), (1, 7), (2, 2), (3, 500), (500, 3), (400, 900), (900, 400)]
)
def test_masses_are_whole_above_nothing_and_of_equal_sums(n, m):
    rng = np.random.default_rng(n + m)
    supply, demand = overlap_masses(rng.random((n, 3)), rng.random((m, 3)))
    assert supply.shape == (n,)
    assert demand.shape == (m,)
    assert supply.dtype == demand.dtype == np.int64
    assert min(supply.min(), demand.min()) >= 1
    assert supply.sum() == demand.sum() == pytest.approx(TOTAL_MASS, rel=1e-5)


def test_what_one_cloud_lacks_hardly_counts():
    rng = np.random.default_rng(0)
    old = rng.random((500, 3))
    new = np.concatenate([rng.random((500, 3)), rng.random((300, 3)) + np.array([3, 0, 0])])
    supply, demand = overlap_masses(old, new)
    assert demand[500:].max() <= 1.1 * MIN_SHARE * demand[:500].max()
    assert np.median(supply) == pytest.approx(TOTAL_MASS / 500, rel=0.15)


def test_the_plan_keeps_to_them_and_is_optimal():
    from ot.lp import emd
    from scipy.spatial.distance import cdist

    rng = np.random.default_rng(1)
    start = rng.random((300, 3))
    end = np.concatenate([rng.random((250, 3)), rng.random((150, 3)) + np.array([2, 0, 0])])
    supply, demand = overlap_masses(start, end)
    plan = solve(start, end, TransportOptions(overlap=True))
    np.testing.assert_allclose(np.bincount(plan.rows, plan.mass), supply / supply.sum(), atol=1e-12)
    np.testing.assert_allclose(
        np.bincount(plan.columns, plan.mass), demand / demand.sum(), atol=1e-12
    )
    assert plan.marginal_error < 1e-9
    optimum = emd(
        supply / supply.sum(), demand / demand.sum(), cdist(start, end) ** 2, 10**7, log=True
    )[1]["cost"]
    assert optimum * (1 - 1e-9) <= plan.cost <= optimum * 1.005


def test_what_both_have_stays_in_its_place():
    rng = np.random.default_rng(2)
    start = rng.random((400, 3))
    end = np.concatenate(
        [start + rng.normal(0, 0.01, start.shape), rng.random((400, 3)) + np.array([1, 0, 0])]
    )
    moved = {}
    for shared in (False, True):
        plan = solve(start, end, TransportOptions(overlap=shared))
        old = plan.columns < 400
        way = np.linalg.norm(start[plan.rows[old]] - end[plan.columns[old]], axis=1)
        moved[shared] = np.average(way, weights=plan.mass[old])
    assert moved[True] < 0.3 * moved[False]
