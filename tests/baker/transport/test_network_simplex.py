"""The network simplex: optimal from whatever feasible plan it is given."""

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial.distance import cdist

from baker.transport.network_simplex import NODE, _reduced_cost, improve_cells
from baker.transport.problem import uniform_masses
from baker.transport.space_partition import bisection_plan
from tests.baker.transport.transport_clouds import leaf


def optimum(start, end, supply, demand, power):
    n, m = len(start), len(end)
    rows = np.kron(np.eye(n), np.ones(m))
    columns = np.kron(np.ones(n), np.eye(m))
    cost = (cdist(start, end) ** power).ravel()
    return linprog(cost, A_eq=np.vstack([rows, columns]), b_eq=np.concatenate([supply, demand])).fun


def improve(start, end, near, edges, mass, stops, power, exhaustive):
    n, points = len(start), np.concatenate([start, end])
    near = np.concatenate([near[0], n + near[1]]).astype(np.int32)
    plans = np.array([edges[0], n + np.asarray(edges[1]), mass])
    rows, columns, flow = improve_cells(points, near, plans, np.array(stops), power, exhaustive)
    return rows, columns - n, flow


def improved(start, end, edges, mass, power=2):
    alone = tuple(np.arange(len(side))[:, None] for side in (start, end))
    return improve(start, end, alone, edges, mass, [len(mass)], power, True)


def cost_of(start, end, rows, columns, mass, power=2):
    return float(mass @ np.linalg.norm(start[rows] - end[columns], axis=1) ** power)


def assert_sums(plan, supply, demand):
    rows, columns, mass = plan
    assert (mass > 0).all()
    np.testing.assert_array_equal(np.bincount(rows, mass, len(supply)), supply)
    np.testing.assert_array_equal(np.bincount(columns, mass, len(demand)), demand)


@pytest.mark.parametrize("power", [1, 2])
@pytest.mark.parametrize(("n", "m"), [(9, 14), (20, 20), (40, 25)])
def test_optimal_from_a_plan_without_circles(n, m, power):
    start, end = leaf(n), leaf(m, 1.4, seed=3)
    supply, demand = uniform_masses(n, m)
    plan = improved(start, end, *bisection_plan(start, end, supply, demand, 0), power=power)
    assert_sums(plan, supply, demand)
    assert cost_of(start, end, *plan, power=power) == pytest.approx(
        optimum(start, end, supply, demand, power)
    )
    assert len(plan[0]) < n + m


def test_optimal_from_a_plan_full_of_circles():
    start, end = leaf(12), leaf(8, 1.4, seed=3)
    everywhere = tuple(side.ravel() for side in np.indices((12, 8)))
    mass = np.random.default_rng(0).integers(1, 50, 96)
    supply, demand = np.bincount(everywhere[0], mass), np.bincount(everywhere[1], mass)
    plan = improved(start, end, everywhere, mass)
    assert_sums(plan, supply, demand)
    assert cost_of(start, end, *plan) == pytest.approx(optimum(start, end, supply, demand, 2))


def test_a_plan_in_pieces_is_joined_where_that_is_cheaper():
    start = np.array([[0.0, 0, 0], [1.0, 0, 0], [2.0, 0, 0]])
    crossed = np.array([2, 0, 1])
    rows, columns, _ = improved(start, start + 0.1, (np.arange(3), crossed), np.ones(3, np.int64))
    np.testing.assert_array_equal(columns[np.argsort(rows)], np.arange(3))


def test_many_equal_costs_do_not_run_in_circles():
    lattice = np.indices((6, 6, 1)).reshape(3, -1).T.astype(float)
    supply, _ = uniform_masses(36, 36)
    backwards = (np.arange(36), np.arange(36)[::-1])
    assert cost_of(lattice, lattice, *improved(lattice, lattice, backwards, supply)) == 0.0


def test_a_cell_is_solved_as_if_it_were_alone():
    start, end = leaf(40), leaf(40, 1.4, seed=3)
    rows, columns = np.arange(25), np.random.default_rng(1).permutation(40)[:25]
    mass = np.full(25, 3)
    cell = improved(start, end, (rows, columns), mass)
    inside = np.sort(columns)
    edges = rows, np.searchsorted(inside, columns)
    alone = improved(start[rows], end[inside], edges, mass)
    for found, expected in zip(cell, (alone[0], inside[alone[1]], alone[2]), strict=True):
        np.testing.assert_array_equal(found, expected)


def test_cells_that_are_solved_together_do_not_know_each_other():
    """Not even where the neighbours of a cell's points are in another cell."""
    start, end = leaf(60), leaf(60, 1.4, seed=3)
    mass, halves = np.full(30, 3), np.arange(60).reshape(2, 30)
    cells = [(half, np.random.default_rng(1).permutation(half)) for half in halves]
    near = tuple(np.random.default_rng(2).integers(60, size=(60, 8)) for _ in range(2))
    masses, edges = np.tile(mass, 2), tuple(map(np.concatenate, zip(*cells, strict=True)))
    together = improve(start, end, near, edges, masses, [30, 60], 2, False)
    alone = [improve(start, end, near, cell, mass, [30], 2, False) for cell in cells]
    for found, expected in zip(together, zip(*alone, strict=True), strict=True):
        np.testing.assert_array_equal(found, np.concatenate(expected))


def test_neighbours_partners_lead_near_the_optimum():
    from scipy.spatial import cKDTree

    start, end = leaf(150), leaf(210, 1.1, seed=3)
    supply, demand = uniform_masses(150, 210)
    edges, mass = bisection_plan(start, end, supply, demand, 0)
    near = tuple(cKDTree(side).query(side, np.arange(2, 8))[1] for side in (start, end))
    plan = improve(start, end, near, edges, mass, [len(mass)], 2, False)
    assert_sums(plan, supply, demand)
    assert cost_of(start, end, *plan) <= optimum(start, end, supply, demand, 2) * 1.001


def test_reduced_costs_are_what_numpy_computes():
    random = np.random.default_rng(0)
    n, m = 9, 40
    tree = np.zeros(n + m + 1, NODE)
    places, prices = random.random((n + m, 3)), random.random(n + m)
    for axis, name in enumerate("xyz"):
        tree[name][:-1] = places[:, axis]
    tree["potential"][:-1] = prices
    for power in (1, 2):
        costs = cdist(places[:n], places[n:]) ** power - prices[:n, None] - prices[n:]
        found = [[_reduced_cost(tree, i, n + j, power) for j in range(m)] for i in range(n)]
        np.testing.assert_allclose(found, costs)
