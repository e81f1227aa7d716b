"""From plans to movers: every point used, few pairs, ties to the lowest index."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from baker.matching.leaflets import match_leaflets
from baker.transport.correspondences import Correspondences, correspond, largest_entries
from baker.transport.problem import Plan, TransportOptions
from baker.transport.solve import solve
from tests.baker.transport.transport_clouds import grown_leaf
from tests.baker.twigs import twig


def plan_of(matrix) -> Plan:
    matrix = np.asarray(matrix, float)
    rows, columns = np.nonzero(matrix >= 0)
    return Plan(
        rows.astype(np.int32), columns.astype(np.int32), matrix[rows, columns], 0.0, 0.0, 0.0, ""
    )


def test_row_and_column_maxima():
    rows, columns = largest_entries(plan_of([[0.5, 0.2, 0.1], [0.1, 0.05, 0.3]]), 2, 3)
    assert list(zip(rows, columns, strict=True)) == [(0, 0), (0, 1), (1, 2)]


def test_ties_go_to_the_lowest_index():
    rows, columns = largest_entries(plan_of(np.full((3, 2), 1 / 6)), 3, 2)
    assert list(zip(rows, columns, strict=True)) == [(0, 0), (0, 1), (1, 0), (2, 0)]


@settings(max_examples=40, deadline=None)
@given(st.integers(1, 40), st.integers(1, 40))
def test_every_point_moves_and_there_are_few_movers(n, m):
    rows, columns = largest_entries(solve(*grown_leaf(n, m)), n, m)
    np.testing.assert_array_equal(np.unique(rows), np.arange(n))
    np.testing.assert_array_equal(np.unique(columns), np.arange(m))
    assert max(n, m) <= len(rows) <= n + m


def divided(start: np.ndarray, end: np.ndarray, attachments: tuple[int, int]) -> Correspondences:
    parts = match_leaflets(start, end, attachments)
    return correspond(start, end, TransportOptions(), parts)


def own_share(found, before, after) -> float:
    """Of the pairs that start on a leaf, how many end on the same one."""
    leaf = before.leaf[found.rows]
    return float((leaf == after.leaf[found.columns])[leaf >= 0].mean())


@pytest.mark.parametrize("seed", range(3))
def test_leaves_born_take_no_points_of_the_old_ones(seed):
    before, after = twig(6, seed), twig(9, seed + 9, stretch=1.1, swell=1.2)
    feet = (before.foot, after.foot)
    plain = correspond(before.points, after.points, TransportOptions())
    leaflets = divided(before.points, after.points, feet)
    assert own_share(leaflets, before, after) > 0.85
    assert own_share(plain, before, after) < 0.7
    assert "each on its own" in leaflets.notes[0]


def test_mass_that_one_scan_alone_has_draws_nothing_out_of_its_place():
    """Among many leaves born: mostly, against the same parts with even masses."""
    shares = []
    for seed in range(8):
        before, after = twig(6, seed), twig(14, seed + 9, stretch=1.1, swell=1.2)
        feet = (before.foot, after.foot)
        shared = divided(before.points, after.points, feet)
        own = total = 0
        for part in match_leaflets(before.points, after.points, feet):
            placed = part.registered or (before.points[part.start], after.points[part.end])
            rows, columns = largest_entries(solve(*placed), len(part.start), len(part.end))
            leaf = before.leaf[part.start[rows]]
            own += ((leaf == after.leaf[part.end[columns]]) & (leaf >= 0)).sum()
            total += (leaf >= 0).sum()
        shares.append((own_share(shared, before, after), own / total))
    with_shared_masses, with_even_masses = np.median(shares, axis=0)
    assert with_shared_masses > with_even_masses + 0.005


def test_every_point_is_in_a_pair_once_with_each_partner():
    before, after = twig(6, 0), twig(8, 1, stretch=1.1)
    found = divided(before.points, after.points, (before.foot, after.foot))
    assert set(found.rows) == set(range(len(before.points)))
    assert set(found.columns) == set(range(len(after.points)))
    pairs = np.stack([found.rows, found.columns], axis=1)
    np.testing.assert_array_equal(pairs, np.unique(pairs, axis=0))
    assert found.marginal_error < 1e-6


def test_the_distance_is_between_the_points_as_they_are():
    before, after = twig(6, 0), twig(8, 1, stretch=1.1)
    found = divided(before.points, after.points, (before.foot, after.foot))
    moved = before.points + np.array([0.0, 0.0, 100.0])
    far = divided(moved, after.points, (before.foot, after.foot))
    assert found.distance < 5
    assert far.distance == pytest.approx(100, rel=0.1)


def test_an_organ_without_leaflets_has_the_plain_plan():
    rng = np.random.default_rng(0)
    start, end = rng.random((80, 3)) * [8, 1, 0], rng.random((90, 3)) * [9, 1, 0]
    plan = solve(start, end)
    rows, columns = largest_entries(plan, 80, 90)
    found = divided(start, end, (0, 0))
    np.testing.assert_array_equal(found.rows, rows)
    np.testing.assert_array_equal(found.columns, columns)
    assert found.distance == plan.distance
    assert found.notes == plan.notes
