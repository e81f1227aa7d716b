"""Find corresponding points of an organ from its transport plan (end of section 3.4)."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from baker.matching.leaflets import LeafletPair
from baker.transport.problem import Indices, Plan, Points, TransportOptions, balance, costs
from baker.transport.solve import solve


@dataclass(frozen=True)
class Correspondences:
    """Pairs of points of an organ in two scans; every point is in at least one pair."""

    rows: Indices  # (M,) points of the start, M <= n + m; sorted by row, then column
    columns: Indices  # (M,) points of the end
    # (Mean cost of the pairs)^(1 / power), in length units: the Wasserstein distance, if the organ
    # is transported as a whole
    distance: float
    marginal_error: float  # L1 error of the marginals, the largest of all plans
    solver: str  # of the part with the largest cost
    notes: tuple[str, ...] = ()  # for the report, one sentence each


def correspond(
    start: Points, end: Points, options: TransportOptions, parts: Sequence[LeafletPair] = ()
) -> Correspondences:
    """Pair the points of an organ by optimal transport.

    start, end: (n, 3) and (m, 3), the organ in two successive scans, in length units. parts: a
    partition of the points into parts that are transported separately, with `overlap_masses`, so
    that the points of a leaf are not transported to new leaves next to it.
    """
    whole = LeafletPair(np.arange(len(start)), np.arange(len(end)), (start, end))
    options = replace(options, overlap=bool(parts))
    rows, columns, part_costs, plans = [], [], [], []
    for part in parts or (whole,):
        source, target = start[part.start], end[part.end]
        registered_source, registered_target = part.registered or balance(source, target)
        plan = solve(registered_source, registered_target, options)
        i, j = largest_entries(plan, len(source), len(target))
        rows.append(part.start[i])
        columns.append(part.end[j])
        cost = plan.mass @ costs(source, target, (plan.rows, plan.columns), options.power)
        part_costs.append(float(cost) * (len(target) / len(end)))
        plans.append(plan)
    order = np.lexsort((np.concatenate(columns), np.concatenate(rows)))
    note = f"its leaflets moved each on its own, {len(parts)} parts in all"
    return Correspondences(
        np.concatenate(rows, dtype=np.int32)[order],
        np.concatenate(columns, dtype=np.int32)[order],
        sum(part_costs) ** (1 / options.power),
        max(plan.marginal_error for plan in plans),
        plans[int(np.argmax(part_costs))].solver,
        (note,) if len(parts) > 1 else plans[0].notes,
    )


def largest_entries(plan: Plan, n: int, m: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """The non-zero entries of the paper's T-hat = (T' + T'') / 2, the row and column maxima of T.

    Of equal entries the first one is the maximum. n, m: numbers of rows and columns.
    """
    chosen = np.zeros(len(plan.mass), bool)
    for side, count in ((plan.rows, n), (plan.columns, m)):
        largest, entries = np.zeros(count), np.zeros(count, np.intp)
        np.maximum.at(largest, side, plan.mass)
        backwards = np.flatnonzero(plan.mass == largest[side])[::-1]
        entries[side[backwards]] = backwards  # assignment to equal indices keeps the last value
        chosen[entries] = True
    return plan.rows[chosen], plan.columns[chosen]
