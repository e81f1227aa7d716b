"""Masses that both clouds have: what only one of them shows draws nothing out of its place."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.transport.problem import Masses, Points
from gclip.morton import morton_order

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

NEAREST = 10  # points, within whose reach the other cloud's are counted
LEAST = 0.02  # of an even share: every point is moved
UNITS = 10**9  # of mass in all


def shared_masses(start: Points, end: Points) -> tuple[Masses, Masses]:
    """Whole masses, (n,) and (m,), of equal sums: of each point as much as the other cloud has.

    The ten points of its own cloud nearest to it, itself among them, are within some reach of each
    point; it counts by how many the other cloud has there, of as many points: fully from ten on.
    The clouds are to lie on each other.
    """
    from scipy.spatial import cKDTree

    k = min(NEAREST, len(start), len(end))
    if k < 2:
        shares = np.ones(len(start)), np.ones(len(end))
    else:
        orders = morton_order(start), morton_order(end)
        here, there = cKDTree(start[orders[0]]), cKDTree(end[orders[1]])
        shares = np.empty(len(start)), np.empty(len(end))
        shares[0][orders[0]] = _shared(here, there, k)
        shares[1][orders[1]] = _shared(there, here, k)
    supply, demand = (np.maximum(1, UNITS * (s / s.sum())).astype(np.int64) for s in shares)
    # What rounding has taken goes to the largest, of which it is next to nothing.
    supply[np.argmax(supply)] += max(0, int(demand.sum() - supply.sum()))
    demand[np.argmax(demand)] += max(0, int(supply.sum() - demand.sum()))
    return supply, demand


def _shared(own: cKDTree, other: cKDTree, k: int) -> NDArray[np.float64]:
    reach = own.query(own.data, k=[k])[0][:, 0] * 1.0001
    found = other.query_ball_point(own.data, reach, return_length=True)
    return np.clip(found / other.n * own.n / k, LEAST, 1.0)
