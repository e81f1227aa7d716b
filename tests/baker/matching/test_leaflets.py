"""Limbs in two scans: leaves that both show keep together, and every point goes somewhere."""

import numpy as np
import pytest

from baker.matching.leaflets import match_leaflets
from tests.baker.twigs import blade, twig


def assert_partition(cut, n, m):
    np.testing.assert_array_equal(np.sort(np.concatenate([p.start for p in cut])), np.arange(n))
    np.testing.assert_array_equal(np.sort(np.concatenate([p.end for p in cut])), np.arange(m))
    for part in cut:
        assert len(part.start)
        assert len(part.end)
        if part.registered is not None:
            assert part.registered[0].shape == (len(part.start), 3)
            assert part.registered[1].shape == (len(part.end), 3)
            assert np.isfinite(part.registered[0]).all()


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("born", [0, 1, 3])
def test_a_leaf_goes_to_itself_whatever_is_born_above(born, seed):
    before, after = twig(6, seed), twig(6 + born, seed + 9, stretch=1.1, swell=1.2)
    cut = match_leaflets(before.points, after.points, (before.foot, after.foot))
    assert_partition(cut, len(before.points), len(after.points))
    limbs = cut[1:]
    assert len(limbs) >= 4
    for limb in limbs:
        one = np.bincount(before.leaf[limb.start] + 1).argmax() - 1
        # The end of the stalk is a limb, too.
        assert one < 0 or np.bincount(after.leaf[limb.end] + 1).argmax() - 1 == one


def test_the_rest_is_compared_where_growth_is_taken_out():
    before, after = twig(6, 1), twig(6, 2, stretch=1.3)
    cut = match_leaflets(before.points, after.points, (before.foot, after.foot))
    rest = cut[0]
    stalk = before.leaf[rest.start] < 0
    share = before.points[rest.start[stalk], 2] / before.points[:, 2].max()
    # Growth taken out, equal shares of the stalk lie on each other.
    there = rest.registered[1][after.leaf[rest.end] < 0]
    true = after.points[rest.end[after.leaf[rest.end] < 0], 2] / after.points[:, 2].max()
    off = rest.registered[0][stalk, 2] - np.interp(
        share, *(v[np.argsort(true)] for v in (true, there[:, 2]))
    )
    assert np.abs(off).mean() < 0.02 * np.ptp(there[:, 2])


def test_a_blade_has_no_match_leaflets():
    rng = np.random.default_rng(0)
    start, end = blade(rng, 300, 8.0, 2.0), blade(rng, 400, 10.0, 2.5)
    assert match_leaflets(start, end, (int(start[:, 0].argmin()), int(end[:, 0].argmin()))) == []


def test_a_fork_is_too_little_to_go_by():
    before, after = twig(1, 0), twig(1, 1)
    assert match_leaflets(before.points, after.points, (before.foot, after.foot)) == []


def test_a_twig_that_has_lost_its_leaves_stays_whole():
    before = twig(6)
    bare = before.points[before.leaf < 0]
    assert match_leaflets(before.points, bare, (before.foot, 0)) == []
    assert match_leaflets(bare, before.points, (0, before.foot)) == []


def test_leaflets_of_quite_other_shares_leave_an_organ_whole():
    before, after = twig(6, 0), twig(6, 1)
    stalk = np.repeat(after.points[after.leaf < 0], 5, axis=0)
    stalk += np.random.default_rng(0).normal(0, 0.05, stalk.shape)
    points = np.concatenate([after.points, stalk])
    assert match_leaflets(before.points, points, (before.foot, after.foot)) == []
