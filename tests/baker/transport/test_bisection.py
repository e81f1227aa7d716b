"""Plans that are feasible by construction, and even, compact blocks."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from baker.transport import bisection
from baker.transport.problem import uniform_masses
from tests.baker.transport.transport_clouds import grown_leaf, leaf


def assert_feasible(plan, supply, demand):
    (rows, columns), mass = plan
    assert (mass > 0).all()
    np.testing.assert_array_equal(np.bincount(rows, mass, len(supply)), supply)
    np.testing.assert_array_equal(np.bincount(columns, mass, len(demand)), demand)


@settings(deadline=None)
@given(st.integers(1, 60), st.integers(1, 60), st.integers(0, 99))
def test_coupling_is_feasible_for_any_sizes(n, m, seed):
    masses = uniform_masses(n, m)
    plan = bisection.couple(*grown_leaf(n, m), *masses, seed)
    assert_feasible(plan, *masses)
    assert len(plan[1]) <= n + m - 1


def test_one_cloud_twice_is_coupled_with_itself_whatever_the_order():
    """Halves are halved down to single points, or partners would lie anywhere in a block."""
    start = leaf(300)
    end = start[np.random.default_rng(5).permutation(300)]
    (rows, columns), _ = bisection.couple(start, end, *uniform_masses(300, 300), seed=2)
    np.testing.assert_array_equal(start[rows], end[columns])


@settings(deadline=None)
@given(st.integers(2, 60), st.integers(2, 60), st.integers(1, 9), st.integers(1, 9))
def test_expanding_a_plan_of_blocks_keeps_it(n, m, blocks_n, blocks_m):
    start, end = grown_leaf(n, m)
    supply, demand = uniform_masses(n, m)
    rows, columns = bisection.cut(start, blocks_n, 0), bisection.cut(end, blocks_m, 0)
    coarse_edges, coarse_mass = bisection.couple(
        rows.centres(start), columns.centres(end), rows.masses(supply), columns.masses(demand), 1
    )
    plan = bisection.expand(rows, columns, supply, demand, coarse_edges, coarse_mass)
    assert_feasible(plan, supply, demand)
    assert (plan[1] > 0).all()
    row_block, column_block = np.empty(n, int), np.empty(m, int)
    row_block[rows.order] = np.searchsorted(rows.first, np.arange(n), "right") - 1
    column_block[columns.order] = np.searchsorted(columns.first, np.arange(m), "right") - 1
    between = np.zeros((len(rows), len(columns)), int)
    np.add.at(between, (row_block[plan[0][0]], column_block[plan[0][1]]), plan[1])
    expected = np.zeros_like(between)
    np.add.at(expected, coarse_edges, coarse_mass)
    np.testing.assert_array_equal(between, expected)


@pytest.mark.parametrize("count", [1, 7, 64, 500])
def test_blocks_hold_every_point_once_and_equally_many(count):
    blocks = bisection.cut(leaf(500), count, 3)
    np.testing.assert_array_equal(np.sort(blocks.order), np.arange(500))
    assert np.ptp(np.diff(blocks.first, append=500)) <= 1


def test_blocks_are_compact():
    points = leaf(4000)
    blocks = bisection.cut(points, 64, 0)
    spread = [points[part].std(axis=0).max() for part in np.split(blocks.order, blocks.first[1:])]
    assert max(spread) < 0.25 * points.std(axis=0).max()
