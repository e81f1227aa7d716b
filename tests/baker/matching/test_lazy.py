"""Deciding by few of many distances: the outcome is that of all."""

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from baker.matching.assignment import assign_by_minima
from baker.matching.lazy import LazyCosts, least


class Counted:
    """Costs that count how many are asked for, with bounds of some slack below them."""

    def __init__(self, costs, slack, seed=0):
        self.costs, self.asked = np.asarray(costs, float), 0
        share = np.random.default_rng(seed).random(self.costs.shape)
        self.lazy = LazyCosts(self.costs - slack * share, self.cost)

    def cost(self, i, j):
        self.asked += 1
        return float(self.costs[i, j])


def assigned(costs):
    """The paper's way, by all costs."""
    n, m = costs.shape
    rows, columns = np.arange(n), np.arange(m)
    if n > m:
        rows = np.sort(np.argsort(costs.min(axis=1), kind="stable")[:m])
    elif m > n:
        columns = np.sort(np.argsort(costs.min(axis=0), kind="stable")[:n])
    i, j = linear_sum_assignment(costs[np.ix_(rows, columns)])
    return list(zip(rows[i].tolist(), columns[j].tolist(), strict=True))


def places(n, m, seed, integer):
    random = np.random.default_rng(seed)
    here, there = random.random((n, 2)), random.random((m, 2))
    apart = np.linalg.norm(here[:, None] - there, axis=2)
    return np.floor(4 * apart) if integer else apart


@pytest.mark.parametrize("integer", [False, True], ids=["distinct", "full of ties"])
@pytest.mark.parametrize("slack", [0.0, 0.05, 1.0, 1e3])
@pytest.mark.parametrize("shape", [(1, 1), (1, 5), (6, 1), (7, 7), (12, 9), (9, 14)])
def test_the_assignment_is_that_of_all_costs(shape, slack, integer):
    for seed in range(12):
        costs = places(*shape, seed, integer)
        assert assign_by_minima(Counted(costs, slack, seed).lazy) == assigned(costs)


def test_minima_and_all():
    costs = places(8, 11, 3, False)
    for axis in (0, 1):
        assert Counted(costs, 0.3).lazy.minima(axis).tolist() == costs.min(axis=axis).tolist()
    counted = Counted(costs, 0.3)
    assert counted.lazy.all().tolist() == costs.tolist()
    counted.lazy.minima(0)
    assert counted.asked == costs.size  # once each


def test_good_bounds_leave_most_costs_alone():
    for shape in (60, 60), (60, 50), (50, 60):
        costs = places(*shape, 0, False)
        counted = Counted(costs, 0.01)
        assert assign_by_minima(counted.lazy) == assigned(costs)
        assert counted.asked < 0.15 * costs.size


def test_two_assignments_as_good_are_told_by_all_costs():
    """Which of them is taken must not hang on what was asked for."""
    for seed in range(20):
        costs = np.random.default_rng(seed).integers(1, 3, (6, 6)).astype(float)
        assert assign_by_minima(Counted(costs, 0.9, seed).lazy) == assigned(costs)


@pytest.mark.parametrize("limit", [0.0, 1.0, 2.0, 2.5, 9.0])
def test_the_least_is_the_least_of_all_below_the_limit(limit):
    random = np.random.default_rng(int(10 * limit))
    for _ in range(50):
        values = random.integers(0, 6, random.integers(0, 9)).astype(float)
        bounds = values - random.integers(0, 3, len(values))
        asked = []

        def distance(index, values=values, asked=asked):
            asked.append(index)
            return float(values[index])

        found = least(bounds, distance, limit)
        below = [(value, index) for index, value in enumerate(values.tolist()) if value < limit]
        assert found == min(below, default=None)
        assert len(set(asked)) == len(asked)
        assert not any(bounds[index] >= limit for index in asked)
