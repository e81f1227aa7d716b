"""The network simplex on the complete bipartite graph of two small clouds.

The transport problem is the linear program

    minimise    sum_ij T_ij c_ij,    c_ij = |p_i - q_j| ** power
    subject to  sum_j T_ij = a_i,  sum_i T_ij = b_j,  T >= 0

A basic solution has flow only on the arcs of a spanning tree. Its node potentials u, v make the
reduced cost c_ij - u_i - v_j zero on these arcs. An arc (i, j) with a negative reduced cost enters
the tree, flow is pushed around the cycle that it closes, and an arc without flow leaves the tree.

Three things adapt the method to geometry. It starts from a nearly optimal plan. It prices the
partners of a point's neighbours before all other arcs: for squared distances, a plan that is
optimal among these is optimal ("shielding"; a few nearest neighbours are nearly sufficient). And it
solves cells that are small enough for the processor's cache. docs/method.md has a comparison with
POT, whose solver has no initial plan and needs a dense cost matrix.

The module is compiled by numba: import it in functions.

References
----------
R. K. Ahuja, T. L. Magnanti, J. B. Orlin: Network Flows, chapter 11 (1993).
P. Kovacs: Minimum-cost flow algorithms: an experimental evaluation (2015).
B. Schmitzer: A sparse multiscale algorithm for dense optimal transport, J. Math. Imaging Vis. 56
(2016).
W. H. Cunningham: A network simplex method, Math. Program. 11 (1976).
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.transport.compiled import compiled
from baker.transport.problem import Coupling, Edges, Masses

NO_NODE: Any = np.uint32(0xFFFFFFFF)  # in the place of the index of a node
TOLERANCE = 1e-12  # share of the largest cost; reduced costs above minus this are not negative
UNBOUNDED = 2**62  # more than any flow

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# The spanning tree: rows, then columns, then an artificial root. A node is one cache line.
NODE = np.dtype(
    [
        ("x", np.float64),
        ("y", np.float64),
        ("z", np.float64),
        ("potential", np.float64),
        ("flow", np.int64),  # on the arc to the parent; 0 if that is the root
        ("parent", np.uint32),  # these four are indices of nodes, or NO_NODE
        ("first_child", np.uint32),
        ("next_sibling", np.uint32),
        ("previous_sibling", np.uint32),
        ("size", np.uint32),  # number of nodes of the subtree, including this one
        ("stack", np.uint32),  # memory for the stack of traversals, unrelated to the node
    ]
)
Tree = Any  # (n + m + 1,) ndarray of NODE
Node = Any  # the index of a node, uint32


@compiled
def improve_cells(
    points: Floats, near: Ints, plans: Coupling, stops: Ints, power: int, exhaustive: bool
) -> Coupling:
    """Find the plan of least cost between the points of each feasible plan, with the same masses.

    Points that are in no pair of a plan are left out. The plans returned have the arcs with flow of
    a spanning tree.

    points: (P, 3), those of the start before those of the end. near: (P, k) neighbours of each
    point in its own cloud, whose partners are priced first. plans: (3, E) points at the start and
    the end of pairs and their masses, plan after plan, like those returned. stops: (cells,) the end
    of each plan. power: the cost of a pair is distance ** power. exhaustive: whether all pairs are
    priced in the end, which guarantees that a plan is optimal.
    """
    # The node of each point in the tree of the current cell, and the points of its nodes.
    nodes, members = np.full(len(points), NO_NODE), np.empty(2 * plans.shape[1], np.int64)
    arcs, improved = np.empty(plans.shape, np.uint32), np.empty((3, len(members)), np.int64)
    begin, found = 0, 0
    for stop in stops:
        n = _number_points(plans[0, begin:stop], nodes, members, 0, arcs[0, begin:stop])
        count = _number_points(plans[1, begin:stop], nodes, members, n, arcs[1, begin:stop])
        tree, near_nodes = np.empty(count + 1, NODE), np.empty((count, near.shape[1]), np.uint32)
        for v in range(count):
            tree[v].x, tree[v].y, tree[v].z = points[members[v]]
            for k in range(near.shape[1]):
                near_nodes[v, k] = nodes[near[members[v], k]]
        ends, mass = (arcs[0, begin:stop], arcs[1, begin:stop]), plans[2, begin:stop]
        network_simplex(tree, n, near_nodes, ends, mass, power, exhaustive)
        for v in range(count):
            nodes[members[v]] = NO_NODE
            if tree[v].flow > 0:
                a, b = members[v], members[tree[v].parent]
                improved[0, found], improved[1, found] = min(a, b), max(a, b)
                improved[2, found] = tree[v].flow
                found += 1
        begin = stop
    return improved[:, :found].copy()


@compiled
def _number_points(ends: Ints, nodes: Ints, members: Ints, count: int, numbers: Ints) -> int:
    """Number the points at the ends of arcs from `count` on; returns the next number."""
    for arc in range(len(ends)):
        if nodes[ends[arc]] == NO_NODE:
            nodes[ends[arc]], members[count] = count, ends[arc]
            count += 1
        numbers[arc] = nodes[ends[arc]]
    return count


@compiled
def network_simplex(
    tree: Tree, n: int, near: Ints, ends: Edges, mass: Masses, power: int, exhaustive: bool
) -> None:
    """Turn a feasible plan into an optimal spanning tree, in place.

    tree: with coordinates. n: number of rows. near: (n + m, k) neighbours. ends, mass: two (E,) and
    (E,) nodes and flow of the arcs of the plan.
    """
    tails, heads = ends
    root, rows = np.uint32(len(tree) - 1), np.uint32(n)
    in_tree = np.zeros(len(tails), np.bool_)
    largest_cost = _build_tree(tree, tails, heads, mass, power, in_tree)
    tolerance = TOLERANCE * largest_cost
    # A plan with cycles has more arcs than a tree; the other arcs enter with their flow.
    for arc in range(len(tails)):
        if not in_tree[arc]:
            reduced = _reduced_cost(tree, tails[arc], heads[arc], power)
            _pivot(tree, rows, tails[arc], heads[arc], reduced, mass[arc])
    while True:
        node, idle = np.uint32(0), np.uint32(0)
        while near.shape[1] > 0 and idle < root:
            reduced, partner = _price_near(tree, near, node, power, -tolerance)
            idle += np.uint32(1)
            if partner != NO_NODE:
                row, column = (node, partner) if node < rows else (partner, node)
                _pivot(tree, rows, row, column, reduced, np.int64(0))
                idle = np.uint32(0)
            node = np.uint32(node + 1) if node + 1 < root else np.uint32(0)
        if not exhaustive:
            return
        # Price all pairs once, row by row, and then near ones again, until no arc enters.
        node, idle, priced, entered = np.uint32(0), np.uint32(0), np.uint32(0), False
        while idle < rows and (near.shape[1] == 0 or priced < rows):
            reduced, partner = _price_all(tree, rows, node, power, -tolerance)
            idle, priced = idle + np.uint32(1), priced + np.uint32(1)
            if partner != NO_NODE:
                _pivot(tree, rows, node, partner, reduced, np.int64(0))
                idle, entered = np.uint32(0), True
            node = np.uint32(node + 1) if node + 1 < rows else np.uint32(0)
        if near.shape[1] == 0 or not entered:
            return


@compiled
def _build_tree(
    tree: Tree, tails: Ints, heads: Ints, mass: Masses, power: int, in_tree: NDArray[np.bool_]
) -> float:
    """Build a spanning tree of the plan's arcs, except those that close a cycle.

    `in_tree` is set for its arcs; returns the largest cost among them.
    """
    root = np.uint32(len(tree) - 1)
    for v in range(len(tree)):
        tree[v].parent, tree[v].first_child, tree[v].flow = NO_NODE, NO_NODE, 0
        tree[v].potential, tree[v].size = 0.0, 1
    # Adjacency lists: the arcs of v are arcs[first[v] : first[v + 1]].
    first = np.zeros(len(tree) + 1, np.int64)
    for arc in range(len(tails)):
        first[tails[arc] + 2] += 1
        first[heads[arc] + 2] += 1
    for v in range(2, len(first)):
        first[v] += first[v - 1]
    arcs = np.empty(2 * len(tails), np.int64)
    for arc in range(len(tails)):
        for v in (tails[arc], heads[arc]):
            arcs[first[v + 1]] = arc
            first[v + 1] += 1
    order, reached, largest = np.empty(root, np.uint32), 0, 0.0
    for seed in range(root):
        if tree[seed].parent != NO_NODE:
            continue
        _attach(tree, np.uint32(seed), root)
        tree[0].stack, height = seed, 1
        while height > 0:
            height -= 1
            v = tree[height].stack
            order[reached] = v
            reached += 1
            for position in range(first[v], first[v + 1]):
                arc = arcs[position]
                w = heads[arc] if tails[arc] == v else tails[arc]
                if tree[w].parent == NO_NODE:
                    in_tree[arc] = True
                    _attach(tree, w, v)
                    # The reduced cost of an arc of the tree is 0.
                    cost = _reduced_cost(tree, v, w, power)
                    tree[w].flow, tree[w].potential = mass[arc], cost
                    largest = max(largest, cost + tree[v].potential)
                    tree[height].stack = w
                    height += 1
    for position in range(len(order) - 1, -1, -1):
        v = order[position]
        tree[tree[v].parent].size += tree[v].size
    return largest


@compiled
def _price_near(tree: Tree, near: Ints, v: Node, power: int, limit: float) -> tuple[float, Node]:
    """The least reduced cost below the limit of arcs to partners of neighbours, and that partner.

    The partners of a neighbour are the nodes to which it has an arc in the tree.
    """
    root, best = np.uint32(len(tree) - 1), NO_NODE
    for w in near[v]:
        if w == NO_NODE:
            continue
        partner, following = tree[w].parent, tree[w].first_child
        while partner != NO_NODE:
            if partner != root:
                cost = _reduced_cost(tree, v, partner, power)
                if cost < limit:
                    limit, best = cost, partner
            partner = following
            if partner != NO_NODE:
                following = tree[partner].next_sibling
    return limit, best


@compiled
def _price_all(tree: Tree, n: Node, row: Node, power: int, limit: float) -> tuple[float, Node]:
    """The least reduced cost below the limit of a row's arcs, and the column."""
    best = NO_NODE
    for column in range(n, np.uint32(len(tree) - 1)):
        cost = _reduced_cost(tree, row, np.uint32(column), power)
        if cost < limit:
            limit, best = cost, np.uint32(column)
    return limit, best


@compiled
def _pivot(tree: Tree, n: Node, row: Node, column: Node, reduced: float, carried: Any) -> None:
    """Let an arc enter the tree and another one, whose flow becomes 0, leave it.

    reduced: the reduced cost of the entering arc; carried: the flow that it has already.

    If the flow of several arcs becomes 0, the last one along the cycle leaves, in the direction of
    the flow from the apex. So all arcs without flow point to the root, the tree stays strongly
    feasible, and degenerate pivots do not cycle (Cunningham 1976).
    """
    root = np.uint32(len(tree) - 1)
    # Climb to the apex of the cycle; the smaller subtree can't contain the other node.
    a, row_flow, row_leaving = row, UNBOUNDED, NO_NODE
    b, column_flow, column_leaving = column, UNBOUNDED, NO_NODE
    while a != b:
        if tree[a].size <= tree[b].size:
            flow, above = tree[a].flow, tree[a].parent
            if flow < row_flow and (a < n or above == root):
                row_flow, row_leaving = flow, a
            a = above
        else:
            flow, above = tree[b].flow, tree[b].parent
            if flow <= column_flow and b >= n and above != root:
                column_flow, column_leaving = flow, b
            b = above
    apex = a
    on_row_side = row_flow < column_flow
    moved, leaving = (row_flow, row_leaving) if on_row_side else (column_flow, column_leaving)
    v, parent = (row, column) if on_row_side else (column, row)
    size = tree[leaving].size
    # Push the flow around the cycle; the size of the leaving subtree is added on the other side.
    w = parent
    while w != apex:
        tree[w].flow += -moved if (w >= n) == on_row_side else moved
        tree[w].size += size
        w = tree[w].parent
    w, lost = v, np.uint32(0)
    while w != apex:
        tree[w].flow += -moved if (w < n) == on_row_side else moved
        tree[w].size -= lost
        lost = size if w == leaving else lost
        w = tree[w].parent
    # Attach the subtree by the entering arc: the path from v up to the leaving arc is reversed.
    top, below, taken, flow = v, parent, np.uint32(0), moved + carried
    while True:
        old_parent, old_flow, old_size = tree[v].parent, tree[v].flow, tree[v].size
        before, after = tree[v].previous_sibling, tree[v].next_sibling
        if before != NO_NODE:
            tree[before].next_sibling = after
        else:
            tree[old_parent].first_child = after
        if after != NO_NODE:
            tree[after].previous_sibling = before
        _attach(tree, v, below)
        tree[v].flow, tree[v].size = flow, size - taken
        if v == leaving:
            break
        taken, flow = old_size, old_flow
        v, below = old_parent, v
    # Only differences of potentials matter: those of the smaller part of the tree are shifted.
    shift, skipped = reduced if on_row_side else -reduced, NO_NODE
    if 2 * size > root:
        shift, skipped, top = -shift, top, root
    tree[0].stack, height = top, 1
    while height > 0:
        height -= 1
        v = tree[height].stack
        tree[v].potential += shift if v < n else -shift
        child = tree[v].first_child
        while child != NO_NODE:
            if child != skipped:
                tree[height].stack = child
                height += 1
            child = tree[child].next_sibling


@compiled
def _attach(tree: Tree, v: Node, parent: Node) -> None:
    sibling = tree[parent].first_child
    tree[v].parent, tree[v].next_sibling, tree[v].previous_sibling = parent, sibling, NO_NODE
    if sibling != NO_NODE:
        tree[sibling].previous_sibling = v
    tree[parent].first_child = v


@compiled
def _reduced_cost(tree: Tree, a: Node, b: Node, power: int) -> float:
    """Equivalent to ``np.linalg.norm(p[a] - q[b]) ** power - u[a] - v[b]``."""
    x, y, z = tree[a].x - tree[b].x, tree[a].y - tree[b].y, tree[a].z - tree[b].z
    cost = x * x + y * y + z * z
    if power == 1:
        cost = np.sqrt(cost)
    return cost - tree[a].potential - tree[b].potential
