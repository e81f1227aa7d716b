"""The north-west corner rule, compiled: a feasible plan between points from one between blocks."""

import numpy as np

from baker.transport.compiled import compiled
from baker.transport.problem import Coupling, Masses


@compiled
def north_west_corner(supply: Masses, demand: Masses, plan: Coupling) -> Coupling:
    """Distribute the mass of each pair of blocks to pairs of their points, in their order.

    supply, demand: (n,) and (m,) masses of the points, block after block. plan: (3, E) rows,
    columns and masses of pairs of blocks, sorted by row, then column, like the plan returned.
    """
    in_block = np.zeros(plan[1].max() + 1, np.int64)
    for pair in range(plan.shape[1]):
        in_block[plan[1, pair]] += plan[2, pair]
    following, column = np.empty_like(in_block), 0  # of each block, the next point to receive mass
    for block in range(len(in_block)):
        following[block] = column
        while in_block[block] > 0:
            in_block[block] -= demand[column]
            column += 1
    refined = np.empty((3, plan.shape[1] + len(supply) + len(demand)), np.int64)
    found, row, given, left = 0, 0, supply[0], demand.copy()
    for pair in range(plan.shape[1]):
        column, rest = following[plan[1, pair]], plan[2, pair]
        while rest > 0:
            while given == 0:
                row += 1
                given = supply[row]
            while left[column] == 0:
                column += 1
            moved = min(rest, given, left[column])
            refined[0, found], refined[1, found], refined[2, found] = row, column, moved
            found, rest, given = found + 1, rest - moved, given - moved
            left[column] -= moved
        following[plan[1, pair]] = column
    return refined[:, :found].copy()
