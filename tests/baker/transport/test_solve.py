"""The exact plan: what holds for every optimal coupling, and how near the dense optimum it is."""

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import cdist

from baker.transport.correspondences import largest_entries
from baker.transport.problem import Plan, TransportOptions, balance, uniform_masses
from baker.transport.solve import explained_cost, solve
from tests.baker.transport.transport_clouds import grown_leaf, leaf


def dense_optimum(start, end, power=2):
    from ot.lp import emd

    n, m = len(start), len(end)
    cost = cdist(start, end) ** power
    return emd(np.full(n, 1 / n), np.full(m, 1 / m), cost, numItermax=10**8, log=True)[1]["cost"]


def assert_coupling(plan: Plan, n: int, m: int, tolerance=1e-12):
    assert (plan.mass > 0).all()
    np.testing.assert_allclose(np.bincount(plan.rows, plan.mass, n), 1 / n, rtol=tolerance * n)
    np.testing.assert_allclose(np.bincount(plan.columns, plan.mass, m), 1 / m, rtol=tolerance * m)
    assert plan.marginal_error < tolerance * (n + m)
    assert len(np.unique(plan.rows.astype(np.int64) * m + plan.columns)) == len(plan.rows)


@pytest.mark.parametrize("power", [1, 2])
@pytest.mark.parametrize(("n", "m"), [(300, 401), (1200, 1200), (1850, 1207)])
def test_cost_within_half_a_percent_of_the_dense_optimum(n, m, power):
    start, end = grown_leaf(n, m)
    plan = solve(start, end, TransportOptions(power=power))
    optimum = dense_optimum(start, end, power)
    assert_coupling(plan, n, m)
    assert optimum * (1 - 1e-9) <= plan.cost <= optimum * 1.002
    assert plan.distance == pytest.approx(plan.cost ** (1 / power))
    assert plan.cost == pytest.approx(
        plan.mass @ np.linalg.norm(start[plan.rows] - end[plan.columns], axis=1) ** power
    )


def test_thousands_of_points_within_half_a_percent():
    start, end = grown_leaf(1900, 2300)
    end += 0.3 * np.sin(7.0 * end[:, ::-1])  # a motion that balancing explains little of
    plan = solve(start, end)
    assert_coupling(plan, 1900, 2300)
    assert plan.cost <= dense_optimum(start, end) * 1.005


def test_what_balancing_leaves_is_near_its_optimum_too():
    here, there = balance(*grown_leaf(1700, 2100))
    optimum = dense_optimum(here, there)
    assert optimum * (1 - 1e-9) <= solve(here, there).cost <= optimum * 1.005


def test_cells_keep_the_masses_and_stay_near_the_optimum():
    start, end = grown_leaf(1501, 2803)
    plan, optimum = solve(start, end), dense_optimum(start, end)
    assert_coupling(plan, 1501, 2803)
    assert optimum * (1 - 1e-9) <= plan.cost <= optimum * 1.0005


def test_as_many_threads_as_wanted_find_the_same_plan():
    start, end = grown_leaf(3001, 4403)
    plans = [solve(start, end, TransportOptions(workers=workers)) for workers in (1, 2, 5)]
    assert pickle.dumps(plans[0]) == pickle.dumps(plans[1]) == pickle.dumps(plans[2])


@pytest.mark.parametrize("n", [400, 1300])
def test_equal_sizes_give_a_bijection(n):
    plan = solve(*grown_leaf(n, n))
    assert len(plan.rows) == n
    assert len(np.unique(plan.rows)) == len(np.unique(plan.columns)) == n


@pytest.mark.parametrize("n", [400, 1300])
@pytest.mark.parametrize("way", [(0, 0, 0), (5.0, -70.0, 900.0)])
def test_identity_and_translation_are_recovered_exactly(n, way):
    start = leaf(n)
    shuffle = np.random.default_rng(1).permutation(n)
    plan = solve(start, (start + way)[shuffle])
    np.testing.assert_array_equal(shuffle[plan.columns], plan.rows)
    assert plan.distance == pytest.approx(np.linalg.norm(way), abs=1e-9)


def test_growth_and_stretching_are_recovered_exactly():
    start = leaf(1300)
    plan = solve(start, start * (3.0, 1.2, 0.8) + (0, 0, 50.0))
    np.testing.assert_array_equal(plan.rows, plan.columns)


@pytest.mark.parametrize(("n", "m"), [(700, 900), (1500, 1100)])
def test_no_two_neighbours_gain_by_swapping(n, m):
    start, end = grown_leaf(n, m)
    plan = solve(start, end)
    p, q = start[plan.rows], end[plan.columns]
    gain = -((p[:, None] - p[None]) * (q[:, None] - q[None])).sum(axis=2)
    assert (gain > 1e-9).mean() < 1e-4


@pytest.mark.parametrize(("n", "m"), [(1, 1), (1, 5), (2, 3), (7, 1), (30, 3000), (20, 60_000)])
def test_wildly_different_sizes(n, m):
    start, end = grown_leaf(n, m)
    plan = solve(start, end)
    assert_coupling(plan, n, m, 1e-10)
    rows, columns = largest_entries(plan, n, m)
    assert len(np.unique(rows)) == n
    assert len(np.unique(columns)) == m


@pytest.mark.parametrize(("n", "m"), [(1100, 1000), (1100, 1100), (40, 30)])
@pytest.mark.parametrize(
    "shape",
    [
        lambda x: np.zeros_like(x),
        lambda x: x[:, :1] * [1.0, 2.0, 3.0],
        lambda x: x * [1.0, 1.0, 0.0],
        lambda x: np.repeat(x[::10], 10, axis=0)[: len(x)],
        lambda x: np.round(x, 1),
        lambda x: x * 1e-9 + 1e3,
        lambda x: x * 1e7,
    ],
    ids=["one place", "line", "plane", "tenfold", "lattice", "tiny and far", "huge"],
)
def test_degenerate_clouds(n, m, shape):
    start, end = shape(leaf(n)), shape(leaf(m, 1.2, seed=5))
    for before, after in ((start, end), (start, leaf(m))):
        plan = solve(before, after)
        assert_coupling(plan, n, m)
        assert plan.cost <= dense_optimum(before, after) * 1.005 + 1e-12


@settings(max_examples=60, deadline=None)
@given(st.integers(1, 12), st.integers(1, 12), st.integers(0, 10**6), st.sampled_from([1, 2]))
def test_small_lattices_are_solved_exactly(n, m, seed, power):
    random = np.random.default_rng(seed)
    start, end = random.integers(0, 3, (n, 3)) * 1.0, random.integers(0, 3, (m, 3)) * 1.0
    plan = solve(start, end, TransportOptions(power=power))
    assert_coupling(plan, n, m)
    assert plan.cost == pytest.approx(dense_optimum(start, end, power), abs=1e-9)


def test_clouds_far_apart():
    start, end = grown_leaf(1201, 1850)
    far = solve(start, end + np.array([0, 0, 1e4]))
    near = solve(start, end)
    assert far.cost - near.cost == pytest.approx(
        1e8 + 2e4 * (end.mean(axis=0) - start.mean(axis=0))[2], rel=1e-9
    )


def test_the_reverse_has_the_same_cost():
    start, end = grown_leaf(1201, 1850)
    assert solve(end, start).cost == pytest.approx(solve(start, end).cost, rel=1e-3)


def test_same_input_same_bytes_and_picklable():
    start, end = grown_leaf(1201, 1850)
    first, second = solve(start, end), solve(start.copy(), end.copy())
    assert pickle.dumps(first) == pickle.dumps(second)
    assert pickle.loads(pickle.dumps(first)).cost == first.cost


def test_single_precision_input():
    start, end = (cloud.astype(np.float32) for cloud in grown_leaf(1201, 1850))
    assert solve(start, end).cost == pytest.approx(solve(start.astype(float), end).cost)


def test_balancing_leaves_the_optimal_plan():
    start, end = grown_leaf(150, 210)
    here, there = balance(start, end)
    taken = explained_cost(start, end, here, there)
    assert dense_optimum(here, there) + taken == pytest.approx(dense_optimum(start, end))
    assert dense_optimum(here, there) < 0.05 * dense_optimum(start, end)
    np.testing.assert_allclose(here.T @ here / 150, there.T @ there / 210, rtol=0.02, atol=1e-4)


@given(st.integers(1, 500), st.integers(1, 500))
def test_uniform_masses_are_uniform_and_balanced(n, m):
    supply, demand = uniform_masses(n, m)
    assert supply.sum() == demand.sum()
    assert len(np.unique(supply)) == len(np.unique(demand)) == 1
