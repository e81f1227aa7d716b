"""From plans to movers: every point used, few pairs, ties to the lowest index."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from baker.transport.correspondences import movers
from baker.transport.problem import Plan
from baker.transport.solve import solve
from tests.baker.transport.transport_clouds import grown_leaf


def plan_of(matrix) -> Plan:
    matrix = np.asarray(matrix, float)
    rows, columns = np.nonzero(matrix >= 0)
    return Plan(
        rows.astype(np.int32), columns.astype(np.int32), matrix[rows, columns], 0.0, 0.0, 0.0, ""
    )


def test_row_and_column_maxima_with_their_weights():
    rows, columns, weight = movers(plan_of([[0.5, 0.2, 0.1], [0.1, 0.05, 0.3]]), 2, 3)
    assert list(zip(rows, columns, weight, strict=True)) == [(0, 0, 1), (0, 1, 0.5), (1, 2, 1)]


def test_ties_go_to_the_lowest_index():
    rows, columns, weight = movers(plan_of(np.full((3, 2), 1 / 6)), 3, 2)
    assert list(zip(rows, columns, weight, strict=True)) == [
        (0, 0, 1), (0, 1, 0.5), (1, 0, 0.5), (2, 0, 0.5),
    ]  # fmt: skip


def test_a_plan_that_leaves_out_a_point_is_refused():
    with pytest.raises(ValueError, match="1 of the 2 points of the end"):
        movers(plan_of([[1.0, -1.0]]), 1, 2)


@settings(max_examples=40, deadline=None)
@given(st.integers(1, 40), st.integers(1, 40))
def test_every_point_moves_and_there_are_few_movers(n, m):
    rows, columns, weight = movers(solve(*grown_leaf(n, m)), n, m)
    np.testing.assert_array_equal(np.unique(rows), np.arange(n))
    np.testing.assert_array_equal(np.unique(columns), np.arange(m))
    assert max(n, m) <= len(rows) <= n + m
    assert weight.sum() == (n + m) / 2
    assert set(weight.tolist()) <= {0.5, 1.0}
