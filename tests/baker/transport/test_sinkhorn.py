"""The regularised plan: POT's on feasible supports, a usable one with a clear note on others."""

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from baker.transport.correspondences import largest_entries
from baker.transport.problem import TransportOptions, balance, costs
from baker.transport.sinkhorn import nearest_pairs, sinkhorn_scaling
from baker.transport.solve import solve
from tests.baker.transport.transport_clouds import grown_leaf, leaf

PLAIN = TransportOptions("sinkhorn", power=1, feasible=False)


@pytest.mark.parametrize("gamma", [1.0, 0.1, 0.02])
@pytest.mark.parametrize(("n", "m"), [(30, 30), (25, 40)])
def test_equals_pot_on_dense_supports(n, m, gamma):
    from ot.bregman import sinkhorn_log

    start, end = grown_leaf(n, m)
    cost = cdist(start, end) ** 2
    epsilon = gamma * np.median(cost)
    expected = sinkhorn_log(
        np.full(n, 1 / n), np.full(m, 1 / m), cost, epsilon, numItermax=100_000, stopThr=1e-12
    )
    every = np.divmod(np.arange(n * m), m)
    options = TransportOptions(tolerance=1e-11, iterations=100_000)
    mass, _, _ = sinkhorn_scaling(every, cost.ravel() / epsilon, n, m, options)
    np.testing.assert_allclose(mass, expected.ravel(), atol=1e-6 / max(n, m))


def test_the_option_reaches_the_same_plan_through_balancing():
    from ot.bregman import sinkhorn_log

    start, end = grown_leaf(20, 28)
    options = TransportOptions(
        "sinkhorn", neighbors=50, gamma=0.5, tolerance=1e-11, iterations=50_000
    )
    plan = solve(start, end, options)
    epsilon = 0.5 * np.median(cdist(*balance(start, end)) ** 2)
    expected = sinkhorn_log(
        np.full(20, 1 / 20), np.full(28, 1 / 28), cdist(start, end) ** 2, epsilon,
        numItermax=100_000, stopThr=1e-12,
    )  # fmt: skip
    found = np.zeros((20, 28))
    found[plan.rows, plan.columns] = plan.mass
    np.testing.assert_allclose(found, expected, atol=1e-6)


def test_costs_of_any_size_stay_in_range():
    start, end = grown_leaf(40, 50)
    cost = (cdist(start, end) ** 2).ravel()
    every = np.divmod(np.arange(2000), 50)
    for size in (1e-6, 1.0, 1e4, 1e8):
        options = TransportOptions(iterations=300)
        mass, _, _ = sinkhorn_scaling(every, size * cost / np.median(cost), 40, 50, options)
        assert np.isfinite(mass).all()
        np.testing.assert_allclose(np.bincount(every[1], mass), 1 / 50)


def test_feasible_support_converges_near_the_exact_plan():
    start, end = grown_leaf(500, 640)
    plan = solve(start, end, TransportOptions("sinkhorn"))
    assert plan.marginal_error < 1.1e-3
    assert not plan.notes
    assert plan.cost == pytest.approx(solve(start, end).cost, rel=0.02)


def test_infeasible_support_is_said_and_the_plan_stays_usable():
    start, end = grown_leaf(500, 640)
    plan = solve(start, end, PLAIN)
    assert "marginal error" in plan.notes[0]
    assert plan.marginal_error > 0.1
    assert np.isfinite(plan.mass).all()
    rows, columns = largest_entries(plan, 500, 640)
    assert (len(np.unique(rows)), len(np.unique(columns))) == (500, 640)
    assert len(rows) <= 1140


def test_on_an_infeasible_support_it_stops_when_five_blocks_gain_less_than_a_percent():
    start, end = grown_leaf(500, 700)
    support = nearest_pairs(start, end, 10)
    cost = costs(start, end, support, 1)
    cost = cost / (0.01 * np.median(cost))

    def error_after(most):
        options = TransportOptions(iterations=most, feasible=False)
        return sinkhorn_scaling(support, cost, 500, 700, options)[1:]

    block, (error, iterations) = 51, error_after(2000)
    assert iterations < 2000
    assert error > 0.99 * error_after(iterations - 5 * block)[0]
    # Not a block too late.
    before = iterations - block
    assert error_after(before)[0] <= 0.99 * error_after(before - 5 * block)[0]


def test_a_point_without_mass_keeps_its_nearest_neighbour():
    # Nine points crowd at 0, one is far out; the far one's only neighbours are taken by the crowd.
    start = np.array([[0.001 * i, 0, 0] for i in range(9)] + [[50.0, 0, 0]])
    end = np.array([[0.001 * i, 0, 0] for i in range(10)])
    options = TransportOptions("sinkhorn", power=1, feasible=False, neighbors=1, gamma=1e-3)
    plan = solve(start, end, options)
    assert np.isfinite(plan.mass).all()
    rows, columns = largest_entries(plan, 10, 10)
    assert set(rows) == set(columns) == set(range(10))
    assert columns[rows == 9] == [9]


def test_iteration_limit_is_kept_and_reported():
    plan = solve(*grown_leaf(500, 640), TransportOptions("sinkhorn", iterations=7))
    assert "7 iterations" in plan.notes[0]
    assert plan.marginal_error > 1e-3


@pytest.mark.parametrize("options", [TransportOptions("sinkhorn"), PLAIN], ids=["own", "paper"])
@pytest.mark.parametrize(
    ("start", "end"),
    [
        (np.zeros((30, 3)), np.zeros((20, 3))),
        (np.zeros((1, 3)), leaf(40)),
        (leaf(2), leaf(3, 2.0)),
        (leaf(50)[:, :1] * [1.0, 0.0, 0.0], leaf(60)[:, :1] * [1.0, 1.0, 0.0]),
        (leaf(50), leaf(50)),
        (leaf(50), leaf(70) + 1e5),
    ],
    ids=["one place", "one point", "two", "lines", "same", "far"],
)
def test_degenerate_clouds(options, start, end):
    plan = solve(start, end, options)
    assert np.isfinite(plan.mass).all()
    assert np.isfinite(plan.cost)
    rows, columns = largest_entries(plan, len(start), len(end))
    assert len(np.unique(rows)) == len(start)
    assert len(np.unique(columns)) == len(end)
