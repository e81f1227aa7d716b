"""Large clouds are solved in cells, whose size is bounded wherever the mass is."""

import numpy as np
import pytest

from baker.transport import network_simplex
from baker.transport.multiscale import multiscale_plan
from baker.transport.problem import TransportOptions


def test_cells_are_of_equal_size_where_few_rows_have_much_mass(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A corner that is sparse in the first cloud, and dense in the second one."""
    rng = np.random.default_rng(0)
    start = rng.random((6000, 3)) * [1.0, 1.0, 0.0]
    corner = (start[:, :2] < 0.2).all(axis=1)
    supply = np.where(corner, 20, 1).astype(np.int64)
    end = np.vstack([rng.random((1500, 3)) * [0.2, 0.2, 0.0], rng.random((1500, 3)) * [1, 1, 0]])
    demand = np.full(len(end), supply.sum() // len(end), np.int64)
    demand[: supply.sum() - demand.sum()] += 1
    largest, solve = [], network_simplex.improve_cells

    def recording(*arguments):
        sizes = np.diff(arguments[3], prepend=0)  # of the cells, from their ends
        largest.append(sizes.max() / sizes.mean())
        return solve(*arguments)

    monkeypatch.setattr(network_simplex, "improve_cells", recording)
    (rows, columns), mass = multiscale_plan(start, end, supply, demand, TransportOptions())
    assert np.array_equal(np.bincount(rows, mass), supply)
    assert np.array_equal(np.bincount(columns, mass), demand)
    assert max(largest) < 1.5
