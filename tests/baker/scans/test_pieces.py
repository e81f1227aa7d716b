"""Connected pieces are those that scipy finds."""

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from baker.scans.pieces import pieces


@pytest.mark.parametrize("count", [1, 2, 10, 1000])
@pytest.mark.parametrize("share", [0.0, 0.3, 0.5, 1.0, 3.0])
def test_pieces_are_the_connected_components(count, share):
    random = np.random.default_rng(count)
    one, other = random.integers(0, count, (2, int(share * count)))
    linked = coo_matrix((np.ones(len(one)), (one, other)), shape=(count, count))
    number, piece = connected_components(linked, directed=False)
    found = pieces(count, one, other)
    assert len(np.unique(found)) == number
    for k in range(number):
        assert (found[piece == k] == np.flatnonzero(piece == k).min()).all()


def test_a_chain_in_any_order_is_one_piece():
    order = np.random.default_rng(0).permutation(5000)
    assert not pieces(5000, order[:-1], order[1:]).any()
