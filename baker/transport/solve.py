"""One pair of segments in, one transport plan out (paper, section 3.4)."""

from __future__ import annotations

from baker.transport.masses import shared_masses
from baker.transport.multiscale import (
    MAX_POINTS_OF_ONE_CELL,
    MAX_POINTS_PRICED_AT_ONCE,
    Search,
    couple,
)
from baker.transport.problem import (
    Method,
    Plan,
    Points,
    TransportOptions,
    checked,
    make_plan,
    uniform_masses,
)
from baker.transport.sinkhorn import regularized_plan
from baker.transport.support import balance, explained_cost

_SLACK = 1e-4  # share of the whole cost below which an improvement is not worth a sweep


def solve(start: Points, end: Points, options: TransportOptions | None = None) -> Plan:
    """The transport plan between a segment's points at two times, each side of mass 1.

    start, end: (n, 3) and (m, 3) finite floats, in any order, duplicates allowed.

    Their masses are uniform, unless `options.shared`. The exact method minimises
    sum(T * distance ** power) over couplings T: clouds that are
    small together (n m up to 1.5 million) to the optimum, others to within 0.5 % of it. Raises
    ValueError where a side is empty, not (n, 3), or not finite.
    """
    options = options or TransportOptions()
    start, end = checked(start), checked(end)
    if options.method == Method.SINKHORN:
        return regularized_plan(start, end, options)

    n, m = len(start), len(end)
    # Where the clouds are does not matter to squared distances, only to rounding.
    here = start - start.mean(axis=0)
    there = end - (end if options.power == 2 else start).mean(axis=0)
    slack = 0.0
    whole = n + m <= MAX_POINTS_OF_ONE_CELL  # one sweep finds the optimum
    # Of few points all pairs are looked at: it does not matter how they lie.
    if options.power == 2 and not (whole and min(n, m) <= MAX_POINTS_PRICED_AT_ONCE):
        here, there = balance(start, end)
        if not whole:
            slack = _SLACK * explained_cost(start, end, here, there)
    search = Search(options.power, options.seed, slack, options.workers)
    masses = shared_masses(start, end) if options.shared else uniform_masses(n, m)
    found = couple(here, there, *masses, search)
    return make_plan(
        start, end, found.edges, found.mass / found.mass.sum(), options.power, found.solver,
        iterations=found.sweeps, masses=masses,
    )  # fmt: skip
