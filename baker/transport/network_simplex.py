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

Compiled by numba: import this module late. All this is one file: numba, which keeps machine code by
file, does not see that another changes.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.geometry.compiled import compiled

_NONE: Any = np.uint32(0xFFFFFFFF)  # no node; numbers without a sign need not be checked for it
_ROUNDING = 1e-12  # share of the largest cost below which a pair is not cheaper
_PLENTY = 2**62
_BLOCK: Any = np.uint32(16)  # columns that lie together

Ints = NDArray[np.integer]  # int32, or uint32 where they are numbers of nodes
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
        ("parent", np.uint32),  # these four are numbers of nodes, or _NONE
        ("child", np.uint32),  # the first one
        ("after", np.uint32),  # the next sibling
        ("before", np.uint32),
        ("size", np.uint32),  # nodes of its subtree, itself among them
        ("stack", np.uint32),  # room to work in, of no node in particular
    ]
)
Tree = NDArray[np.void]  # (N + 1,) of NODE
Node = np.uint32 | int  # its number


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
    local_row = np.full(len(start), _NONE, np.uint32)
    local_column = np.full(len(end), _NONE, np.uint32)
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
        near = np.empty((count, near_start.shape[1]), np.uint32)
        for x in range(near.shape[1]):
            for i in range(n):
                near[i, x] = local_row[near_start[own_rows[i], x]]
            for j in range(n, count):
                other = local_column[near_end[own_columns[j - n], x]]
                near[j, x] = np.uint32(other + n) if other != _NONE else _NONE
        tails = local_row[rows[span]]
        heads = local_column[columns[span]] + np.uint32(n)
        _plant(tree, np.uint32(n), tails, heads, mass[span], power)
        _optimize(tree, np.uint32(n), near, power, exhaustive)
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
            local[member] = np.uint32(size)
            distinct[size] = member
            size += 1
    return distinct[:size]


@compiled
def _optimize(tree: Tree, n: Node, near: Ints, power: int, exhaustive: bool) -> None:
    """Let pairs in, as long as there are cheaper ones."""
    count = len(tree) - 1
    largest = 0.0
    for node in range(count):
        if tree[node].parent < count:
            largest = max(largest, _cost(tree, node, tree[node].parent, power))
    tolerance = _ROUNDING * largest
    while True:
        _try_nearby(tree, n, near, power, tolerance)
        if not exhaustive or not _try_all(tree, n, power, tolerance, near.shape[1] == 0):
            return


@compiled
def _try_nearby(tree: Tree, n: Node, near: Ints, power: int, tolerance: float) -> None:
    """Let pairs in, as long as there are cheaper ones among the partners of neighbours."""
    count = len(tree) - 1
    v, quiet = np.uint32(0), 0
    while near.shape[1] and quiet < count:
        reduced, other = _cheapest_nearby(tree, near, v, power, -tolerance)
        quiet += 1
        if other != _NONE:
            i, j = (v, other) if v < n else (other, v)
            _pivot(tree, n, i, j, reduced, 0)
            quiet = 0
        v = np.uint32(v + 1) if v + 1 < count else np.uint32(0)


@compiled
def _try_all(tree: Tree, n: Node, power: int, tolerance: float, persist: bool) -> bool:
    """Let in each row's cheapest pair, if there is a cheaper one; returns whether any came in.

    persist: go on until none is cheaper, instead of looking at each row once.

    Columns are looked at in blocks, where the block's box and its highest price let one be cheaper.
    """
    count = np.uint32(len(tree) - 1)
    boxes = _boxes(tree, n)
    highest = np.empty(len(boxes))
    _find_highest(tree, n, highest)
    row, quiet, looked, came = np.uint32(0), 0, 0, False
    while quiet < n and (persist or looked < n):
        reduced, other = -tolerance, _NONE
        for block in range(len(boxes)):
            least = _cost_to_box(tree, row, boxes[block], power)
            if least - tree[row].potential - highest[block] < reduced:
                begin = n + np.uint32(block * _BLOCK)
                for j in range(begin, min(begin + _BLOCK, count)):
                    cost = _reduced_cost(tree, row, j, power)
                    if cost < reduced:
                        reduced, other = cost, j
        quiet, looked = quiet + 1, looked + 1
        if other != _NONE:
            _pivot(tree, n, row, other, reduced, 0)
            _find_highest(tree, n, highest)
            quiet, came = 0, True
        row = np.uint32(row + 1) if row + 1 < n else np.uint32(0)
    return came and not persist


@compiled
def _boxes(tree: Tree, n: Node) -> Floats:
    """(blocks, 6) the lowest and the highest coordinates of each block of columns."""
    count = np.uint32(len(tree) - 1)
    boxes = np.empty(((count - n + _BLOCK - 1) // _BLOCK, 6))
    for j in range(n, count):
        block, x, y, z = (j - n) // _BLOCK, tree[j].x, tree[j].y, tree[j].z
        box = boxes[block]
        if (j - n) % _BLOCK == 0:
            box[0], box[1], box[2], box[3], box[4], box[5] = x, y, z, x, y, z
        box[0], box[1], box[2] = min(box[0], x), min(box[1], y), min(box[2], z)
        box[3], box[4], box[5] = max(box[3], x), max(box[4], y), max(box[5], z)
    return boxes


@compiled
def _find_highest(tree: Tree, n: Node, highest: Floats) -> None:
    """Put each block's highest price there."""
    highest[:] = -np.inf
    for j in range(n, np.uint32(len(tree) - 1)):
        block = (j - n) // _BLOCK
        highest[block] = max(highest[block], tree[j].potential)


@compiled
def _cost_to_box(tree: Tree, v: Node, box: Floats, power: int) -> float:
    x = max(box[0] - tree[v].x, tree[v].x - box[3], 0.0)
    y = max(box[1] - tree[v].y, tree[v].y - box[4], 0.0)
    z = max(box[2] - tree[v].z, tree[v].z - box[5], 0.0)
    squared = x * x + y * y + z * z
    return squared if power == 2 else np.sqrt(squared)


@compiled
def _plant(tree: Tree, n: Node, tails: Ints, heads: Ints, mass: Longs, power: int) -> None:
    """Grow a tree along the plan's pairs.

    Where the pairs run in circles they are too many for a tree: those left over come in one by
    one, with the mass that they carry, as if they were cheaper.
    """
    root = np.uint32(len(tree) - 1)
    for v in range(len(tree)):
        tree[v].parent, tree[v].child, tree[v].flow, tree[v].potential = _NONE, _NONE, 0, 0.0
    first, incident = _incidence(tails, heads, root)
    planted = np.zeros(len(tails), np.bool_)
    order = np.empty(root, np.uint32)
    reached = 0
    for base in range(root):
        if tree[base].parent != _NONE:
            continue
        _attach(tree, base, root)
        tree[0].stack, size = base, 1
        while size > 0:
            size -= 1
            v = tree[size].stack
            order[reached] = v
            reached += 1
            for x in range(first[v], first[v + 1]):
                e = incident[x]
                w = heads[e] if tails[e] == v else tails[e]
                if tree[w].parent == _NONE:
                    planted[e] = True
                    _attach(tree, w, v)
                    tree[w].flow = mass[e]
                    tree[w].potential = _cost(tree, v, w, power) - tree[v].potential
                    tree[size].stack = w
                    size += 1
    _measure(tree, order)
    for e in range(len(tails)):
        if not planted[e]:
            reduced = _reduced_cost(tree, tails[e], heads[e], power)
            _pivot(tree, n, tails[e], heads[e], reduced, mass[e])


@compiled
def _measure(tree: Tree, order: Ints) -> None:
    """Count each subtree's nodes; `order` has parents before their children."""
    for v in range(len(tree)):
        tree[v].size = 1
    for x in range(len(order) - 1, -1, -1):
        v = order[x]
        tree[tree[v].parent].size += tree[v].size


@compiled
def _incidence(tails: Ints, heads: Ints, count: Node) -> tuple[Longs, Longs]:
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
def _cheapest_nearby(
    tree: Tree, near: Ints, v: Node, power: int, limit: float
) -> tuple[float, int]:
    """Of point v and its neighbours' partners: the least reduced cost below the limit, and whom."""
    root, best = np.uint32(len(tree) - 1), _NONE
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
def _pivot(tree: Tree, n: Node, i: Node, j: Node, reduced: float, carried: int) -> None:
    """Let the pair of row i and column j into the tree, and out one that this empties.

    reduced: the pair's reduced cost; carried: the mass that it carries already.

    Mass goes round the circle that the new pair closes until some pair of it is empty. If several
    are, the last one goes, in the direction of the flow from the circle's top on: so every empty
    pair left in the tree points to the root, and steps that move no mass can't go round in circles
    (Cunningham, Math. Program. 11, 1976).
    """
    root = np.uint32(len(tree) - 1)
    a, moved, emptied = i, _PLENTY, _NONE
    b, moved_beyond, emptied_beyond = j, _PLENTY, _NONE
    while a != b:
        if tree[a].size <= tree[b].size:
            flow, above = tree[a].flow, tree[a].parent
            if flow < moved and (a < n or above == root):
                moved, emptied = flow, a
            a = above
        else:
            flow, above = tree[b].flow, tree[b].parent
            if flow <= moved_beyond and b >= n and above != root:
                moved_beyond, emptied_beyond = flow, b
            b = above
    top = a
    on_row_side = moved < moved_beyond
    if not on_row_side:
        moved, emptied = moved_beyond, emptied_beyond
    v, parent = (i, j) if on_row_side else (j, i)
    size = tree[emptied].size
    w = parent
    while w != top:
        tree[w].flow += -moved if (w >= n) == on_row_side else moved
        tree[w].size += size
        w = tree[w].parent
    w = v
    while moved > 0 and w != emptied:
        tree[w].flow += -moved if (w < n) == on_row_side else moved
        w = tree[w].parent
    w = tree[emptied].parent
    while w != top:
        tree[w].flow += -moved if (w < n) == on_row_side else moved
        tree[w].size -= size
        w = tree[w].parent
    _hang(tree, v, parent, emptied, moved + carried)
    shift = reduced if on_row_side else -reduced
    # Prices count against each other only: the smaller side of the tree is brought in line.
    if 2 * size <= root:
        _shift(tree, n, v, _NONE, shift)
    else:
        _shift(tree, n, root, v, -shift)


@compiled
def _hang(tree: Tree, v: Node, parent: Node, last: Node, flow: int) -> None:
    """Hang v on a new parent, and the path from v up to `last` upside down below v."""
    size, taken = tree[last].size, np.uint32(0)
    while True:
        old_parent, old_flow, old_size = tree[v].parent, tree[v].flow, tree[v].size
        _detach(tree, v)
        _attach(tree, v, parent)
        tree[v].flow = flow
        tree[v].size = size - taken
        if v == last:
            return
        taken = old_size
        v, parent, flow = old_parent, v, old_flow


@compiled
def _shift(tree: Tree, n: Node, top: Node, without: Node, row_shift: float) -> None:
    """Shift the prices of the subtree of `top`, without that of one of its nodes."""
    tree[0].stack, size = top, 1
    while size > 0:
        size -= 1
        v = tree[size].stack
        tree[v].potential += row_shift if v < n else -row_shift
        child = tree[v].child
        while child != _NONE:
            if child != without:
                tree[size].stack = child
                size += 1
            child = tree[child].after


@compiled
def _attach(tree: Tree, v: Node, parent: Node) -> None:
    sibling = tree[parent].child
    tree[v].parent, tree[v].after, tree[v].before = parent, sibling, _NONE
    if sibling != _NONE:
        tree[sibling].before = v
    tree[parent].child = v


@compiled
def _detach(tree: Tree, v: Node) -> None:
    before, after = tree[v].before, tree[v].after
    if before != _NONE:
        tree[before].after = after
    else:
        tree[tree[v].parent].child = after
    if after != _NONE:
        tree[after].before = before


@compiled
def _reduced_cost(tree: Tree, a: Node, b: Node, power: int) -> float:
    return _cost(tree, a, b, power) - tree[a].potential - tree[b].potential


@compiled
def _cost(tree: Tree, a: Node, b: Node, power: int) -> float:
    x, y, z = tree[a].x - tree[b].x, tree[a].y - tree[b].y, tree[a].z - tree[b].z
    squared = x * x + y * y + z * z
    return squared if power == 2 else np.sqrt(squared)
