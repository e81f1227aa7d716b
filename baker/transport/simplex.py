"""A feasible plan between points made optimal: the network simplex, fitted to geometry.

The network simplex keeps a spanning tree of pairs and lets one pair in for one out, as long as
that is cheaper (as implemented in LEMON: Kiraly and Kovacs, Acta Univ. Sapientiae 4, 2012). Three
things make it fast here. It starts from a plan that is nearly right. It looks for cheaper pairs
only among the partners of a point's neighbours: for the squared distance, a plan that is optimal
against these is optimal against everything ("shielding", Schmitzer, J. Math. Imaging Vis. 56,
2016; a few nearest neighbours come close to the neighbours that this needs). And it works on
cells, so small that their data stay in the cache.

Libraries' solvers start from nothing and take the pairs as a list: for the same optimum POT's
network simplex needs 5 to 30 times as long (bench/transport.py).

Compiled by numba: import this module late.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.compiled import compiled

_NONE = -1
_ROUNDING = 1e-12  # share of the largest cost below which a pair is not cheaper
_PLENTY = 2**62

Ints = NDArray[np.integer]  # int32
Longs = NDArray[np.integer]  # int64
Floats = NDArray[np.floating]  # float64


# A spanning tree is an array of nodes: rows, then columns, then an artificial root. A node is one
# line of the processor's cache.
NODE = np.dtype(
    [
        ("x", np.float64),
        ("y", np.float64),
        ("z", np.float64),
        ("potential", np.float64),  # dual price: on every edge of the tree they sum to its cost
        ("flow", np.int64),  # mass between the node and its parent; 0 where that is the root
        ("parent", np.int32),  # these four are numbers of nodes, or -1
        ("child", np.int32),  # the first one
        ("after", np.int32),  # the next sibling
        ("before", np.int32),
        ("depth", np.int32),  # edges to the root
        ("stack", np.int32),  # room to work in, of no node in particular
    ]
)
Tree = NDArray[np.void]  # (N + 1,) of NODE


@compiled
def improve_cells(
    start: Floats,
    end: Floats,
    near_start: Ints,
    near_end: Ints,
    rows: Longs,
    columns: Longs,
    mass: Longs,
    first: Longs,
    power: int,
    exhaustive: bool,
) -> tuple[Longs, Longs, Longs]:
    """Solve each cell of a feasible plan for the masses that its rows send and receive now.

    start, end: (n, 3) and (m, 3); near_start (n, k), near_end (m, k): neighbours on the own side.
    rows, columns, mass: (E,) the plan, cell after cell; every row is in one cell only.
    first:      (cells + 1,) where in the plan each cell begins.
    power:      2 or 1: a pair's cost is distance ** power.
    exhaustive: look at all pairs of a cell in the end, which makes it optimal for certain.

    Returns the new plan's rows, columns and masses.
    """
    local_row = np.full(len(start), _NONE, np.int32)
    local_column = np.full(len(end), _NONE, np.int32)
    room = 2 * len(rows)  # a cell's tree has fewer pairs than points, and two points for each pair
    new_rows, new_columns = np.empty(room, np.int64), np.empty(room, np.int64)
    new_mass = np.empty(room, np.int64)
    size = 0
    for cell in range(len(first) - 1):
        span = slice(first[cell], first[cell + 1])
        own_rows = _numbered(rows[span], local_row)
        own_columns = _numbered(columns[span], local_column)
        n, count = len(own_rows), len(own_rows) + len(own_columns)
        tree = np.empty(count + 1, NODE)
        for v in range(count):
            point = start[own_rows[v]] if v < n else end[own_columns[v - n]]
            tree[v].x, tree[v].y, tree[v].z = point[0], point[1], point[2]
        near = np.empty((count, near_start.shape[1]), np.int32)
        for x in range(near.shape[1]):
            for i in range(n):
                near[i, x] = local_row[near_start[own_rows[i], x]]
            for j in range(n, count):
                other = local_column[near_end[own_columns[j - n], x]]
                near[j, x] = other + n if other >= 0 else _NONE
        tails = local_row[rows[span]]
        heads = local_column[columns[span]] + np.int32(n)
        _plant(tree, n, tails, heads, mass[span], power)
        _optimize(tree, n, near, power, exhaustive)
        for v in range(count):
            if tree[v].flow > 0:
                i, j = (v, tree[v].parent) if v < n else (tree[v].parent, v)
                new_rows[size] = own_rows[i]
                new_columns[size] = own_columns[j - n]
                new_mass[size] = tree[v].flow
                size += 1
        local_row[own_rows] = _NONE
        local_column[own_columns] = _NONE
    return new_rows[:size].copy(), new_columns[:size].copy(), new_mass[:size].copy()


@compiled
def _numbered(members: Longs, local: Ints) -> Longs:
    """The distinct members in the order in which they come; `local` gets their numbers."""
    distinct = np.empty(len(members), np.int64)
    size = 0
    for member in members:
        if local[member] == _NONE:
            local[member] = size
            distinct[size] = member
            size += 1
    return distinct[:size]


@compiled
def _optimize(tree: Tree, n: int, near: Ints, power: int, exhaustive: bool) -> None:
    """Let pairs in, as long as there are cheaper ones."""
    count = len(tree) - 1
    largest = 0.0
    for v in range(count):
        if tree[v].parent < count:
            largest = max(largest, _cost(tree, v, tree[v].parent, power))
    tolerance = _ROUNDING * largest
    v, quiet = 0, 0
    while quiet < count:
        reduced, other = _cheapest_nearby(tree, near, v, power, -tolerance)
        quiet += 1
        if other != _NONE:
            i, j = (v, other) if v < n else (other, v)
            _pivot(tree, n, i, j, reduced, 0)
            quiet = 0
        v = v + 1 if v + 1 < count else 0
    i, quiet = 0, 0
    while exhaustive and quiet < n:
        reduced, other = -tolerance, _NONE
        for j in range(n, count):
            cost = _reduced_cost(tree, i, j, power)
            if cost < reduced:
                reduced, other = cost, j
        quiet += 1
        if other != _NONE:
            _pivot(tree, n, i, other, reduced, 0)
            quiet = 0
        i = i + 1 if i + 1 < n else 0


@compiled
def _plant(tree: Tree, n: int, tails: Ints, heads: Ints, mass: Longs, power: int) -> None:
    """Grow a tree along the plan's pairs.

    Where the pairs run in circles they are too many for a tree: those left over come in one by
    one, with the mass that they carry, as if they were cheaper.
    """
    root = len(tree) - 1
    count = root
    for v in range(count + 1):
        tree[v].parent, tree[v].child, tree[v].flow, tree[v].potential = _NONE, _NONE, 0, 0.0
    tree[root].depth = 0
    first, incident = _incidence(tails, heads, count)
    planted = np.zeros(len(tails), np.bool_)
    for base in range(count):
        if tree[base].parent != _NONE:
            continue
        _attach(tree, base, root)
        tree[base].depth = 1
        tree[0].stack, size = base, 1
        while size > 0:
            size -= 1
            v = tree[size].stack
            for x in range(first[v], first[v + 1]):
                e = incident[x]
                w = heads[e] if tails[e] == v else tails[e]
                if tree[w].parent == _NONE:
                    planted[e] = True
                    _attach(tree, w, v)
                    tree[w].depth = tree[v].depth + 1
                    tree[w].flow = mass[e]
                    tree[w].potential = _cost(tree, v, w, power) - tree[v].potential
                    tree[size].stack = w
                    size += 1
    for e in range(len(tails)):
        if not planted[e]:
            reduced = _reduced_cost(tree, tails[e], heads[e], power)
            _pivot(tree, n, tails[e], heads[e], reduced, mass[e])


@compiled
def _incidence(tails: Ints, heads: Ints, count: int) -> tuple[Longs, Longs]:
    """Which pairs each point is in: those of point v stand from first[v] to first[v + 1]."""
    first = np.zeros(count + 1, np.int64)
    for e in range(len(tails)):
        first[tails[e] + 1] += 1
        first[heads[e] + 1] += 1
    first = np.cumsum(first)
    place = first[:-1].copy()
    incident = np.empty(2 * len(tails), np.int64)
    for e in range(len(tails)):
        for v in (tails[e], heads[e]):
            incident[place[v]] = e
            place[v] += 1
    return first, incident


@compiled
def _cheapest_nearby(tree: Tree, near: Ints, v: int, power: int, limit: float) -> tuple[float, int]:
    """Of point v and its neighbours' partners: the least reduced cost below the limit, and whom."""
    root, best = len(tree) - 1, _NONE
    for w in near[v]:
        if w == _NONE:
            continue
        other = tree[w].parent
        if other != root:
            cost = _reduced_cost(tree, v, other, power)
            if cost < limit:
                limit, best = cost, other
        other = tree[w].child
        while other != _NONE:
            cost = _reduced_cost(tree, v, other, power)
            if cost < limit:
                limit, best = cost, other
            other = tree[other].after
    return limit, best


@compiled
def _pivot(tree: Tree, n: int, i: int, j: int, reduced: float, carried: int) -> None:
    """Let the pair of row i and column j into the tree, and out one that this empties.

    reduced: the pair's reduced cost; carried: the mass that it carries already.

    Mass goes round the circle that the new pair closes until some pair of it is empty. If several
    are, the last one goes, in the direction of the flow from the circle's top on: so every empty
    pair left in the tree points to the root, and steps that move no mass can't go round in circles
    (Cunningham, Math. Program. 11, 1976).
    """
    top = _meeting_point(tree, i, j)
    root = len(tree) - 1
    moved, emptied, on_row_side = _PLENTY, _NONE, True
    v = i
    while v != top:
        if (v < n or tree[v].parent == root) and tree[v].flow < moved:
            moved, emptied = tree[v].flow, v
        v = tree[v].parent
    v = j
    while v != top:
        if v >= n and tree[v].parent != root and tree[v].flow <= moved:
            moved, emptied, on_row_side = tree[v].flow, v, False
        v = tree[v].parent
    if moved > 0:
        v = i
        while v != top:
            tree[v].flow += -moved if v < n else moved
            v = tree[v].parent
        v = j
        while v != top:
            tree[v].flow += -moved if v >= n else moved
            v = tree[v].parent
    v, parent = (i, j) if on_row_side else (j, i)
    _hang(tree, v, parent, emptied, moved + carried)
    _shift(tree, n, v, reduced if on_row_side else -reduced)


@compiled
def _meeting_point(tree: Tree, a: int, b: int) -> int:
    while a != b:
        if tree[a].depth >= tree[b].depth:
            a = tree[a].parent
        else:
            b = tree[b].parent
    return a


@compiled
def _hang(tree: Tree, v: int, parent: int, last: int, flow: int) -> None:
    """Hang v on a new parent, and the path from v up to `last` upside down below v."""
    while True:
        old_parent, old_flow = tree[v].parent, tree[v].flow
        _detach(tree, v)
        _attach(tree, v, parent)
        tree[v].flow = flow
        if v == last:
            return
        v, parent, flow = old_parent, v, old_flow


@compiled
def _shift(tree: Tree, n: int, top: int, row_shift: float) -> None:
    """Bring depths and potentials of the subtree of `top` in line with its new parent."""
    tree[0].stack, size = top, 1
    while size > 0:
        size -= 1
        v = tree[size].stack
        tree[v].depth = tree[tree[v].parent].depth + 1
        tree[v].potential += row_shift if v < n else -row_shift
        child = tree[v].child
        while child != _NONE:
            tree[size].stack = child
            size += 1
            child = tree[child].after


@compiled
def _attach(tree: Tree, v: int, parent: int) -> None:
    sibling = tree[parent].child
    tree[v].parent, tree[v].after, tree[v].before = parent, sibling, _NONE
    if sibling != _NONE:
        tree[sibling].before = v
    tree[parent].child = v


@compiled
def _detach(tree: Tree, v: int) -> None:
    before, after = tree[v].before, tree[v].after
    if before != _NONE:
        tree[before].after = after
    else:
        tree[tree[v].parent].child = after
    if after != _NONE:
        tree[after].before = before


@compiled
def _reduced_cost(tree: Tree, a: int, b: int, power: int) -> float:
    return _cost(tree, a, b, power) - tree[a].potential - tree[b].potential


@compiled
def _cost(tree: Tree, a: int, b: int, power: int) -> float:
    x, y, z = tree[a].x - tree[b].x, tree[a].y - tree[b].y, tree[a].z - tree[b].z
    squared = x * x + y * y + z * z
    return squared if power == 2 else np.sqrt(squared)
