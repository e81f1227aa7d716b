"""The paper's method as plain numpy and scipy code, for comparison with `bake`.

    python -m bench.recipe SCANS PAIRS.npz [--labels ignore] [--every N]

This is what a reader of Golla et al. (2020) would first write, on one thread: segmentation by the
minimum spanning tree of the kNN graph; Wasserstein distances and transport by sparse Sinkhorn
iterations on the union of the 15 nearest neighbours. Scans are read by the reader of `bake`. The
pairs of positions of each interval are written to a file. Prints the seconds of segmentation, and
of matching and transport.
"""

from __future__ import annotations

import argparse
import time
import warnings
from pathlib import Path

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import breadth_first_order, connected_components, minimum_spanning_tree
from scipy.spatial import cKDTree

K = 15  # neighbours in the graph, and in the support of the transport plan
ITERATIONS = 200  # of Sinkhorn's algorithm
BRANCH_SHARE = 0.18  # length from which on a path is a branch, as a share of the longest path


def segment(points: np.ndarray) -> np.ndarray:
    """Segment a plant (section 3.2.2).

    Components that are not connected with the root are segments of their own.

    Parameters
    ----------
    points : (N, 3) ndarray

    Returns
    -------
    (N,) int ndarray
        Segment of each point.
    """
    count, k = len(points), min(K + 1, len(points))
    distances, neighbors = cKDTree(points).query(points, k=k)
    rows = np.repeat(np.arange(count), k)
    graph = sp.coo_matrix((distances.ravel() + 1e-12, (rows, neighbors.ravel())), (count, count))
    tree = minimum_spanning_tree(graph.tocsr().maximum(graph.tocsr().T))
    root = int(points[:, 2].argmin())
    order, parent = breadth_first_order(tree, root, directed=False)
    longest = [0] * count
    for v in order[:0:-1]:
        longest[parent[v]] = max(longest[parent[v]], longest[v] + 1)
    threshold = BRANCH_SHARE * longest[root]
    children: dict[int, list[int]] = {}
    for v in order[1:]:
        children.setdefault(int(parent[v]), []).append(int(v))
    cut = tree.tolil()
    for v, followers in children.items():
        branches = [u for u in followers if longest[u] > threshold]
        if len(branches) > 1:
            for u in branches:
                cut[u, v] = cut[v, u] = 0
    return connected_components(cut.tocsr(), directed=False)[1]


def transport(start: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, float]:
    """Solve the transport problem of a pair of segments (section 3.4).

    Parameters
    ----------
    start, end : (N, 3) and (M, 3) ndarray

    Returns
    -------
    pairs : (2, E) int ndarray
        Corresponding points of `start` and `end`.
    cost : float
        Of the plan.
    """
    n, m = len(start), len(end)
    forward, i = cKDTree(end).query(start, k=min(K, m))
    back, j = cKDTree(start).query(end, k=min(K, n))
    rows = np.r_[np.repeat(np.arange(n), min(K, m)), np.reshape(j, -1)]
    columns = np.r_[np.reshape(i, -1), np.repeat(np.arange(m), min(K, n))]
    lengths = np.r_[np.reshape(forward, -1), np.reshape(back, -1)]
    unique = np.unique(rows.astype(np.int64) * m + columns, return_index=True)[1]
    rows, columns, lengths = rows[unique], columns[unique], lengths[unique]
    kernel = sp.csr_matrix((np.exp(-lengths / max(lengths.max(), 1e-12)), (rows, columns)), (n, m))
    transposed = kernel.T.tocsr()
    u, v = np.ones(n), np.ones(m)
    for _ in range(ITERATIONS):
        u = (1 / n) / (kernel @ v)
        v = (1 / m) / (transposed @ u)
    plan = (sp.diags(u) @ kernel @ sp.diags(v)).tocsr()
    cost = float(plan.multiply(sp.csr_matrix((lengths, (rows, columns)), (n, m))).sum())
    best = np.asarray(plan.argmax(axis=1)).ravel(), np.asarray(plan.argmax(axis=0)).ravel()
    pairs = np.c_[np.r_[np.arange(n), best[1]], np.r_[best[0], np.arange(m)]]
    return np.unique(pairs, axis=0).T, cost


def interpolate(
    first: tuple[np.ndarray, np.ndarray], second: tuple[np.ndarray, np.ndarray]
) -> np.ndarray:
    """Transport the segments of the first scan to segments of the second one with equal labels.

    New segments grow from the 30 nearest points of the first scan.

    Parameters
    ----------
    first, second : tuple
        (N, 3) points and (N,) labels of a scan.

    Returns
    -------
    (E, 2, 3) ndarray
        Start and end of each mover.
    """
    (p, p_labels), (q, q_labels) = first, second
    moved = []
    for label in np.unique(q_labels):
        end = q[q_labels == label]
        start = p[p_labels == label]
        if not len(start):
            start = p[np.argsort(cKDTree(end).query(p)[0])[:30]]
        i, j = transport(start, end)[0]
        moved.append(np.stack([start[i], end[j]], axis=1))
    return np.concatenate(moved)


def match(
    first: tuple[np.ndarray, np.ndarray], second: tuple[np.ndarray, np.ndarray]
) -> np.ndarray:
    """Match segments by Wasserstein distances (section 3.3).

    Parameters
    ----------
    first, second : tuple
        (N, 3) points and (N,) labels of a scan.

    Returns
    -------
    (N,) int ndarray
        Labels of the second scan, renamed to those of the first one.
    """
    from scipy.optimize import linear_sum_assignment

    (p, p_labels), (q, q_labels) = first, second
    before, after = np.unique(p_labels), np.unique(q_labels)
    costs = np.array(
        [[transport(p[p_labels == a], q[q_labels == b])[1] for b in after] for a in before]
    )
    renamed = np.full(len(q), -1)
    for new, label in enumerate(after):
        renamed[q_labels == label] = p_labels.max() + 1 + new
    for i, j in zip(*linear_sum_assignment(np.nan_to_num(costs, nan=1e30)), strict=True):
        renamed[q_labels == after[j]] = before[i]
    return renamed


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scans", type=Path)
    parser.add_argument("pairs", type=Path)
    parser.add_argument("--labels", default="consistent", choices=("consistent", "ignore"))
    parser.add_argument("--every", type=int, default=1)
    arguments = parser.parse_args()
    # Infeasible supports divide by zero in this recipe (docs/method.md, row 5).
    warnings.filterwarnings("ignore", category=RuntimeWarning)
    np.seterr(all="ignore")

    from baker.options import Options
    from baker.scans.read import read_series

    has_labels = arguments.labels == "consistent"
    options = Options(every=arguments.every, labels=arguments.labels)
    scans = read_series([arguments.scans], options).scans
    began = time.perf_counter()
    labels = [scan.labels if has_labels else segment(scan.points) for scan in scans]
    segmented = time.perf_counter()
    pairs = []
    for k in range(len(scans) - 1):
        first, second = (scans[k].points, labels[k]), (scans[k + 1].points, labels[k + 1])
        if not has_labels:
            labels[k + 1] = match(first, second)
        pairs.append(interpolate(first, (second[0], labels[k + 1])))
    print(segmented - began, time.perf_counter() - segmented)
    np.savez(arguments.pairs, *pairs)


if __name__ == "__main__":
    main()
