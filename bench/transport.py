"""Exact and regularised transport against POT: seconds, and cost above the dense optimum.

    python -m bench.transport [--sizes 500,1000,...]

A leaf grows by half, bends, and is scanned anew with half as many points again, so that the two
scans share no point and their sizes no common factor; and the same with equal sizes. A solver is
left out, with a dash, where it would need more than a few gigabytes or minutes: at 300,000 points
only ours is left. Costs are relative to POT's dense `emd` or, where that is out of reach, to our
exact plan (marked ~); below zero means that the marginals are not met, as on the paper's plain
support, on which not all of the mass can flow. All costs are of the squared distance.

POT's sparse `emd` is given our plan's pairs and the 20 points nearest to where our plan moves each.
"""

from __future__ import annotations

import argparse
import time
import warnings
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from baker.transport.problem import TransportOptions, costs
from baker.transport.sinkhorn import nearest, unique
from baker.transport.solve import solve

DENSE_LIMIT = 30_000_000  # pairs: a dense emd of about 1.5 GB
SINKHORN_LIMIT = 2_000_000
SPARSE_LIMIT = 1_000_000_000
SPARSE_NEIGHBORS = 20
Cloud = NDArray[np.float64]


def leaf(count: int, length: float, seed: int) -> Cloud:
    random = np.random.default_rng(seed)
    along, across = random.random(count), random.random(count) - 0.5
    width = 0.3 * length * np.sin(np.pi * along)
    points = np.stack(
        [along * length, across * width, 0.3 * length * np.sin(2.0 * along * length**0.3)], axis=1
    )
    return points + random.normal(scale=0.002, size=points.shape)


def squared_distances(start: Cloud, end: Cloud) -> Cloud:
    from scipy.spatial.distance import cdist

    return cdist(start, end, "sqeuclidean")


def pot_emd(start: Cloud, end: Cloud) -> float:
    from ot.lp import emd

    masses = np.full(len(start), 1 / len(start)), np.full(len(end), 1 / len(end))
    return emd(*masses, squared_distances(start, end), numItermax=10**9, log=True)[1]["cost"]


def pot_sparse(start: Cloud, end: Cloud) -> float:
    from ot.lp import emd
    from scipy.sparse import coo_matrix

    plan = solve(start, end, TransportOptions())
    moves = plan.mass[:, None] * (end[plan.columns] - start[plan.rows])
    shift = np.stack([np.bincount(plan.rows, axis, len(start)) for axis in moves.T], axis=1)
    near = nearest(start + len(start) * shift, end, SPARSE_NEIGHBORS)
    pairs = unique(near, (plan.rows, plan.columns))
    cost = costs(start, end, pairs, 2)
    matrix = coo_matrix((cost, pairs), shape=(len(start), len(end)))
    masses = [np.full(len(side), 1.0 / len(side)) for side in (start, end)]
    found = emd(*masses, matrix, numItermax=10**9, check_marginals=False).tocoo()
    return float(found.data @ costs(start, end, (found.row, found.col), 2))


def pot_sinkhorn(start: Cloud, end: Cloud) -> float:
    from ot.bregman import sinkhorn_log

    cost = squared_distances(start, end)
    masses = np.full(len(start), 1 / len(start)), np.full(len(end), 1 / len(end))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # not converged in 500 iterations
        plan = sinkhorn_log(*masses, cost, 0.05 * np.median(cost), numItermax=500, stopThr=1e-3)
    return float((plan * cost).sum())


def ours(**options: object) -> Callable[[Cloud, Cloud], float]:
    return lambda start, end: solve(start, end, TransportOptions(**options)).cost  # type: ignore[arg-type]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", default="500,1000,2000,4000")
    arguments = parser.parse_args()
    sizes = [int(size) for size in arguments.sizes.split(",")]
    solvers: dict[str, tuple[Callable[[Cloud, Cloud], float], float]] = {
        "POT emd, dense": (pot_emd, DENSE_LIMIT),
        "POT emd, sparse": (pot_sparse, SPARSE_LIMIT),
        "POT sinkhorn, dense": (pot_sinkhorn, SINKHORN_LIMIT),
        "exact": (ours(), np.inf),
        "sinkhorn": (ours(method="sinkhorn"), np.inf),
        "paper's sinkhorn": (ours(method="sinkhorn", feasible=False), np.inf),
    }
    ours()(leaf(40, 1.0, 0), leaf(50, 1.0, 1))  # imports are not timed
    print(f"{'points':>18}" + "".join(f"{name:>24}" for name in solvers))
    for size in sizes:
        for n, m in ((size + 1, size * 3 // 2), (size, size)):
            start, end = leaf(n, 1.0, 2 * size), leaf(m, 1.5, 2 * size + 1)
            results = {}
            for name, (solver, limit) in solvers.items():
                if n * m <= limit:
                    before = time.perf_counter()
                    cost = solver(start, end)
                    results[name] = time.perf_counter() - before, cost
            exact = results.get("POT emd, dense", results["exact"])[1]
            sign = " " if "POT emd, dense" in results else "~"
            cells = [
                f"{results[name][0]:.2f} s {sign}{100 * (results[name][1] / exact - 1):+.3f} %"
                if name in results
                else "-"
                for name in solvers
            ]
            print(f"{n:>8} → {m:>7}" + "".join(f"{cell:>24}" for cell in cells), flush=True)


if __name__ == "__main__":
    main()
