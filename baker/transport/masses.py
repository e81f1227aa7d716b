"""Masses that both clouds have: what only one of them shows draws nothing out of its place."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.transport.problem import Masses, Points
from gclip.morton import morton_order

if TYPE_CHECKING:
    from scipy.spatial import KDTree

NEIGHBORS = 10  # points, within whose distance the other cloud's are counted
MIN_SHARE = 0.02  # of a uniform mass: every point is moved
MAX_SAMPLE = 500  # points of a cloud, each for those after it along the Morton curve
TOTAL_MASS = 10**9  # whole units


def shared_masses(start: Points, end: Points) -> tuple[Masses, Masses]:
    """Masses of registered clouds, by how much of the other cloud is around each point.

    A point's mass is the number of the other cloud's points that are no farther than its tenth
    neighbour in its own cloud, of as many points; fully from ten on. Of large clouds a sample is
    looked at. In whole units, at least 1, of equal sums.
    """
    from scipy.spatial import KDTree

    k = min(NEIGHBORS, len(start), len(end))
    if k < 2:
        shares = np.ones(len(start)), np.ones(len(end))
    else:
        source, target = (KDTree(points, balanced_tree=False) for points in (start, end))
        shares = _share(source, target, k), _share(target, source, k)
    supply, demand = (np.maximum(1, TOTAL_MASS * (s / s.sum())).astype(np.int64) for s in shares)
    # What rounding has taken goes to the largest, of which it is next to nothing.
    supply[np.argmax(supply)] += max(0, int(demand.sum() - supply.sum()))
    demand[np.argmax(demand)] += max(0, int(supply.sum() - demand.sum()))
    return supply, demand


def _share(own: "KDTree", other: "KDTree", k: int) -> NDArray[np.float64]:
    order, step = morton_order(own.data), -(-own.n // MAX_SAMPLE)
    sample = own.data[order[::step]]
    radius = own.query(sample, k=[k])[0][:, 0] * 1.0001
    found = other.query_ball_point(sample, radius, return_length=True)
    share = np.empty(own.n)
    share[order] = np.clip(found / other.n * own.n / k, MIN_SHARE, 1.0).repeat(step)[: own.n]
    return share
