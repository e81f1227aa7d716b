"""An organ's pairs: all points are used, and a twig's leaves stay themselves as others are born."""

import numpy as np
import pytest

from baker.matching.leaflets import pieces
from baker.transport.correspondences import movers
from baker.transport.organ_plan import coupled
from baker.transport.problem import TransportOptions
from baker.transport.solve import solve
from tests.baker.twigs import twig


def own_share(found, before, after) -> float:
    """Of the pairs that start on a leaf, how many end on the same one."""
    leaf = before.leaf[found.rows]
    return float((leaf == after.leaf[found.columns])[leaf >= 0].mean())


@pytest.mark.parametrize("seed", range(3))
def test_leaves_born_take_no_points_of_the_old_ones(seed):
    before, after = twig(6, seed), twig(9, seed + 9, stretch=1.1, swell=1.2)
    feet = (before.foot, after.foot)
    plain = coupled(before.points, after.points, TransportOptions())
    limbs = coupled(before.points, after.points, TransportOptions(), feet)
    assert own_share(limbs, before, after) > 0.85
    assert own_share(plain, before, after) < 0.7
    assert "each on its own" in limbs.notes[0]
    assert limbs.limbs
    assert not plain.limbs


def test_mass_that_one_scan_alone_has_draws_nothing_out_of_its_place():
    """Among many leaves born: on the whole, against the same pieces with even masses."""
    shares = []
    for seed in range(8):
        before, after = twig(6, seed), twig(14, seed + 9, stretch=1.1, swell=1.2)
        feet = (before.foot, after.foot)
        shared = coupled(before.points, after.points, TransportOptions(), feet)
        own = total = 0
        for piece in pieces(before.points, after.points, feet):
            rows, columns, _ = movers(
                solve(piece.here, piece.there), len(piece.start), len(piece.end)
            )
            leaf = before.leaf[piece.start[rows]]
            own += ((leaf == after.leaf[piece.end[columns]]) & (leaf >= 0)).sum()
            total += (leaf >= 0).sum()
        shares.append((own_share(shared, before, after), own / total))
    with_shared_masses, with_even_masses = np.mean(shares, axis=0)
    assert with_shared_masses > with_even_masses + 0.005


def test_every_point_is_in_a_pair_once_with_each_partner():
    before, after = twig(6, 0), twig(8, 1, stretch=1.1)
    found = coupled(before.points, after.points, TransportOptions(), (before.foot, after.foot))
    assert set(found.rows) == set(range(len(before.points)))
    assert set(found.columns) == set(range(len(after.points)))
    pairs = np.stack([found.rows, found.columns], axis=1)
    np.testing.assert_array_equal(pairs, np.unique(pairs, axis=0))
    assert found.marginal_error < 1e-6


def test_the_distance_is_between_the_points_as_they_are():
    before, after = twig(6, 0), twig(8, 1, stretch=1.1)
    found = coupled(before.points, after.points, TransportOptions(), (before.foot, after.foot))
    moved = before.points + np.array([0.0, 0.0, 100.0])
    far = coupled(moved, after.points, TransportOptions(), (before.foot, after.foot))
    assert found.distance < 5
    assert far.distance == pytest.approx(100, rel=0.1)


@pytest.mark.parametrize("feet", [None, (0, 0)])
def test_an_organ_without_limbs_has_the_plain_plan(feet):
    rng = np.random.default_rng(0)
    start, end = rng.random((80, 3)) * [8, 1, 0], rng.random((90, 3)) * [9, 1, 0]
    plan = solve(start, end)
    rows, columns, _ = movers(plan, 80, 90)
    found = coupled(start, end, TransportOptions(), feet)
    np.testing.assert_array_equal(found.rows, rows)
    np.testing.assert_array_equal(found.columns, columns)
    assert found.distance == plan.distance
    assert found.notes == plan.notes
