"""Plans that are feasible by construction, and even, compact blocks."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from baker.transport.problem import uniform_masses
from baker.transport.space_partition import (
    bisection_order,
    bisection_plan,
    blocks,
    random_rotation,
    refine_plan,
)
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
    plan = bisection_plan(*grown_leaf(n, m), *masses, seed)
    assert_feasible(plan, *masses)
    assert len(plan[1]) <= n + m - 1


@pytest.mark.parametrize("n", [1, 2, 3, 7, 100, 1000])
def test_each_part_is_cut_at_the_middle_of_its_longest_extent(n):
    """Equal to the plain loop over parts, with a sort for each."""
    points = leaf(n)
    turned = points @ random_rotation(3)
    order, axes = bisection_order(points, 3)
    parts, plain = 1, [np.arange(n)]
    while parts < n:
        cut_along = [np.ptp(turned[part], axis=0).argmax() for part in plain]
        found = axes[parts : 2 * parts]
        assert all(len(p) < 2 or a == b for p, a, b in zip(plain, found, cut_along, strict=True))
        each = zip(plain, cut_along, strict=True)
        whole = np.concatenate([part[np.argsort(turned[part, axis])] for part, axis in each])
        parts *= 2
        plain = np.split(whole, -(-np.arange(1, parts) * n // parts))
    np.testing.assert_array_equal(order, np.concatenate(plain))


def test_one_cloud_twice_is_coupled_with_itself_whatever_the_order():
    """Halves are halved down to single points, or partners would lie anywhere in a block."""
    start = leaf(300)
    end = start[np.random.default_rng(5).permutation(300)]
    (rows, columns), _ = bisection_plan(start, end, *uniform_masses(300, 300), seed=2)
    np.testing.assert_array_equal(start[rows], end[columns])


@settings(deadline=None)
@given(st.integers(2, 60), st.integers(2, 60), st.integers(1, 9), st.integers(1, 9))
def test_expanding_a_plan_of_blocks_keeps_it(n, m, rows, columns):
    start, end = grown_leaf(n, m)
    supply, demand = uniform_masses(n, m)
    (start, coarse_supply), (end, coarse_demand) = (
        blocks(start, supply, rows),
        blocks(end, demand, columns),
    )
    edges, mass = bisection_plan(start, end, coarse_supply, coarse_demand, 1)
    *pairs, handed = refine_plan(supply, demand, np.array([*edges, mass]))
    plan = pairs, handed
    assert_feasible(plan, supply, demand)
    between, expected = np.zeros((2, len(start), len(end)), int)
    row, column = (
        np.searchsorted(np.cumsum(coarse), np.cumsum(fine) - 1, "right")
        for coarse, fine in ((coarse_supply, supply), (coarse_demand, demand))
    )
    np.add.at(between, (row[plan[0][0]], column[plan[0][1]]), plan[1])
    np.add.at(expected, edges, mass)
    np.testing.assert_array_equal(between, expected)


@pytest.mark.parametrize("count", [1, 7, 64, 500, 900])
def test_blocks_are_compact_and_hold_equally_many_points(count):
    points, masses = leaf(500), np.ones(500, int)
    order = bisection_order(points, 0)[0]
    np.testing.assert_array_equal(np.sort(order), np.arange(500))
    centroids, sizes = blocks(points[order], masses, count)
    assert len(centroids) == min(count, 500)
    assert np.ptp(sizes) <= 1
    parts = np.split(points[order], np.cumsum(sizes)[:-1])
    np.testing.assert_allclose(centroids, [part.mean(axis=0) for part in parts])
    if count == 64:
        assert max(part.std(axis=0).max() for part in parts) < 0.25 * points.std(axis=0).max()


def halves(points: np.ndarray, part: int, parts: int, members: np.ndarray) -> list[np.ndarray]:
    """The parts of all levels by sorting each along its longest extent."""
    n = len(points)
    begin, end = -(-part * n // parts), -(-(part + 1) * n // parts)
    if end - begin <= 1:
        return [members]
    axis = np.ptp(points[members], axis=0).argmax()
    members = members[np.argsort(points[members, axis])]
    middle = -(-(2 * part + 1) * n // (2 * parts)) - begin
    return [
        members,
        *halves(points, 2 * part, 2 * parts, members[:middle]),
        *halves(points, 2 * part + 1, 2 * parts, members[middle:]),
    ]


@pytest.mark.parametrize("n", [1, 2, 3, 7, 64, 100])
def test_bisection_is_recursive_halving(n):
    points = np.random.default_rng(n).random((n, 3))
    order, _ = bisection_order(points, 0)
    begin = 0
    for part in halves(points @ random_rotation(0), 0, 1, np.arange(n)):
        if len(part) == 1:
            assert order[begin] == part[0]
            begin += 1
    assert begin == n


def north_west(columns, mass, supply, demand):
    """`refine_plan` pair by pair: where the masses of points begin within those of pairs."""
    by_column = np.argsort(columns, kind="stable")
    row_end, column_end = np.cumsum(supply), np.cumsum(demand)
    begin = np.cumsum(mass) - mass
    begin_in_column = np.empty_like(mass)
    begin_in_column[by_column] = np.cumsum(mass[by_column]) - mass[by_column]
    found = []
    for pair in range(len(mass)):
        ends = np.concatenate([row_end - begin[pair], column_end - begin_in_column[pair]])
        cuts = np.unique([0, mass[pair], *ends[(ends > 0) & (ends < mass[pair])]])
        row = np.searchsorted(row_end, begin[pair] + cuts[:-1], "right")
        column = np.searchsorted(column_end, begin_in_column[pair] + cuts[:-1], "right")
        found += zip(row, column, np.diff(cuts), strict=True)
    return np.array(found).T


@pytest.mark.parametrize("seed", range(10))
def test_refining_is_the_north_west_corner_rule(seed):
    random = np.random.default_rng(seed)
    coarse = random.integers(0, 6, (4, 5))
    coarse[0, :], coarse[:, 0] = 3, 2  # no block is empty
    rows, columns = np.nonzero(coarse)
    mass = coarse[rows, columns]
    # Every block of rows and of columns is two points, one of which may have nothing.
    supply = np.stack([s := coarse.sum(axis=1) // 3, coarse.sum(axis=1) - s], axis=1).ravel()
    demand = np.stack([d := coarse.sum(axis=0) // 2, coarse.sum(axis=0) - d], axis=1).ravel()
    plan = refine_plan(supply, demand, np.array([rows, columns, mass]))
    np.testing.assert_array_equal(plan, north_west(columns, mass, supply, demand))
