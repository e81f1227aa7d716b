"""Time, cost and memory of solvers of the transport problem of one segment.

    python -m bench.transport [--sizes 500,...,500000] [--only NAME,...] [--limit SECONDS]

The segment is a leaf that grows by half of its length and bends between two scans. For every size N
there are two problems: N + 1 and 3N/2 points, and N and N points. Masses are uniform, and costs are
squared distances. Each solver runs in a process of its own. After a solver exceeds `--limit`
seconds it is not run on larger problems, nor is it run if its dense matrix would not fit ("-").

seconds Processor time of all threads, which depends less on other load than wall time.
cost    In percent above the least cost of an unregularised plan of the same problem. Sinkhorn
        iterations trade cost for entropy, or stop before the marginals are met (negative values);
        GeomLoss returns no plan, so that its loss is compared, which includes the entropy.
memory  Increase of the peak memory of the process by the solver, in MB.

Solvers that are not installed are skipped:

POT emd              Network simplex on the dense cost matrix.
POT emd, sparse      The same on the 20 points nearest to where our plan moves each point, and our
                     plan's pairs, without which no plan may exist.
POT sinkhorn         On the dense matrix in the log domain, 500 iterations at most.
GeomLoss             Multiscale Sinkhorn with KeOps on the CPU, blur of half a point spacing.
hierarchical         Hierarchical refinement (Halmos et al. 2025): both clouds are halved by a plan
                     of rank 2 until POT's emd solves the parts. For equal sizes only.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import time
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.transport.problem import TransportOptions, costs
from baker.transport.sinkhorn import nearest_pairs, union
from baker.transport.solve import solve

SIZES = "500,1000,2000,5000,10000,20000,50000,100000,200000,500000"
SPARSE_NEIGHBORS = 20  # candidates of each point in the sparse problem
PART_SIZE = 1000  # points of a part that hierarchical refinement solves with emd
MEMORY_PER_PAIR = 40  # bytes for each pair of points that dense solvers take at least
DENSE = ("POT emd", "POT sinkhorn")
UNREGULARISED = ("bake", "POT emd", "POT emd, sparse", "hierarchical")

Cloud = NDArray[np.float64]
Solver = Callable[[Cloud, Cloud], float]


def leaf(count: int, length: float, seed: int) -> Cloud:
    """(count, 3) points of a bent leaf with the noise of a scanner."""
    random = np.random.default_rng(seed)
    along, across = random.random(count), random.random(count) - 0.5
    width = 0.3 * length * np.sin(np.pi * along)
    points = np.stack(
        [along * length, across * width, 0.3 * length * np.sin(2.0 * along * length**0.3)], axis=1
    )
    return points + random.normal(scale=0.002, size=points.shape)


def problem(n: int, m: int) -> tuple[Cloud, Cloud]:
    """Scans of a leaf with `n` points, and of the grown leaf with `m` points."""
    return leaf(n, 1.0, 2 * n), leaf(m, 1.5, 2 * n + 1)


def ours(**options: Any) -> Solver:
    """The solver of `bake` with some options."""
    return lambda start, end: solve(start, end, TransportOptions(**options)).cost


def pot_emd(start: Cloud, end: Cloud) -> float:
    """Network simplex of POT on the dense cost matrix."""
    from ot.lp import emd

    return emd(*_uniform(start, end), _squared_distances(start, end), 10**9, log=True)[1]["cost"]


def pot_sparse(start: Cloud, end: Cloud) -> float:
    """Network simplex of POT on a sparse cost matrix around the plan of `bake`."""
    from ot.lp import emd
    from scipy.sparse import coo_matrix

    plan = solve(start, end)
    weighted = plan.mass[:, None] * (end[plan.columns] - start[plan.rows])
    displacement = np.stack(
        [np.bincount(plan.rows, axis, len(start)) for axis in weighted.T], axis=1
    )
    neighbors = nearest_pairs(start + len(start) * displacement, end, SPARSE_NEIGHBORS)
    pairs = union(neighbors, (plan.rows, plan.columns))
    matrix = coo_matrix((costs(start, end, pairs, 2), pairs), shape=(len(start), len(end)))
    optimal = emd(*_uniform(start, end), matrix, numItermax=10**9, check_marginals=False).tocoo()
    return float(optimal.data @ costs(start, end, (optimal.row, optimal.col), 2))


def pot_sinkhorn(start: Cloud, end: Cloud) -> float:
    """Sinkhorn's algorithm of POT in the log domain, on the dense cost matrix."""
    from ot.bregman import sinkhorn_log

    cost = _squared_distances(start, end)
    regularization = 0.05 * np.median(cost)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that the iterations did not converge
        plan = sinkhorn_log(*_uniform(start, end), cost, regularization, 500, stopThr=1e-3)
    return float((plan * cost).sum())


def geomloss(start: Cloud, end: Cloud) -> float:
    """Multiscale Sinkhorn loss of GeomLoss."""
    import torch
    from geomloss import SamplesLoss

    spacing = 0.5 / np.sqrt(len(start))  # between points on a leaf with an area of about 0.2
    loss = SamplesLoss(
        "sinkhorn", p=2, blur=spacing / 2, scaling=0.8, debias=False, backend="multiscale"
    )
    # GeomLoss defines the cost as half of the squared distance.
    clouds = (torch.from_numpy(cloud.astype(np.float32)) for cloud in (start, end))
    return 2.0 * float(loss(*clouds))


def hierarchical(start: Cloud, end: Cloud) -> float:
    """Halve both clouds by plans of rank 2 until the parts are small (Halmos et al. 2025)."""
    from ot.lowrank import lowrank_sinkhorn

    n = len(start)
    if n <= PART_SIZE:
        return pot_emd(start, end)
    rows, columns, _ = lowrank_sinkhorn(start, end, rank=2, numItermax=100, warn=False)
    halves = [np.argsort(q[:, 0] / q.sum(axis=1), kind="stable") for q in (rows, columns)]
    cost = 0.0
    for part in (slice(n // 2), slice(n // 2, n)):
        i, j = (half[part] for half in halves)
        cost += len(i) / n * hierarchical(start[i], end[j])
    return cost


def _uniform(start: Cloud, end: Cloud) -> tuple[Cloud, Cloud]:
    return np.full(len(start), 1 / len(start)), np.full(len(end), 1 / len(end))


def _squared_distances(start: Cloud, end: Cloud) -> Cloud:
    from scipy.spatial.distance import cdist

    return cdist(start, end, "sqeuclidean")


SOLVERS: dict[str, Solver] = {
    "bake": ours(),
    "bake, sinkhorn": ours(method="sinkhorn"),
    "POT emd": pot_emd,
    "POT emd, sparse": pot_sparse,
    "POT sinkhorn": pot_sinkhorn,
    "GeomLoss": geomloss,
    "hierarchical": hierarchical,
}


def measure(name: str, n: int, m: int) -> dict[str, float]:
    """Solve one problem in this process; imports and compilation are not measured."""
    SOLVERS[name](*problem(40, 40))
    start, end = problem(n, m)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    began = time.process_time()
    cost = SOLVERS[name](start, end)
    seconds = time.process_time() - began
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return {"seconds": seconds, "cost": cost, "memory": (peak - before) / 1e3}


def run(name: str, n: int, m: int, limit: float) -> dict[str, float] | str:
    """Solve one problem in a process of its own; returns the reason if there is no result."""
    command = [sys.executable, "-m", "bench.transport", "--run", name, "--sizes", f"{n},{m}"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=limit)
    except subprocess.TimeoutExpired:
        return f"> {limit:g} s"
    if done.returncode == 0:
        return json.loads(done.stdout.splitlines()[-1])
    errors = done.stderr.strip().splitlines() or ["killed"]
    return "not installed" if "No module named" in errors[-1] else errors[-1][:40]


def is_feasible(name: str, n: int, m: int, earlier: dict[str, float] | str | None) -> bool:
    """Whether to run a solver on a problem, given its result on a smaller one."""
    if isinstance(earlier, str) or (name == "hierarchical" and n != m):
        return False
    if name in DENSE:
        with open("/proc/meminfo") as file:
            available = next(int(line.split()[1]) for line in file if "MemAvailable" in line)
        return n * m * MEMORY_PER_PAIR < 1e3 * available
    return True


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--sizes", default=SIZES)
    parser.add_argument("--only", default="", help="names of solvers, separated by semicolons")
    parser.add_argument("--limit", type=float, default=300.0, help="seconds of wall time")
    parser.add_argument("--run", default="", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    sizes = [int(size) for size in arguments.sizes.split(",")]
    if arguments.run:
        print(json.dumps(measure(arguments.run, *sizes)))
        return
    chosen = arguments.only.split(";") if arguments.only else [*SOLVERS]
    names = [name for name in SOLVERS if name in chosen]
    print("| points | " + " | ".join(names) + " |\n|" + "---|" * (len(names) + 1))
    last: dict[str, dict[str, float] | str] = {}
    for size in sizes:
        for n, m in ((size + 1, size * 3 // 2), (size, size)):
            results = {
                name: run(name, n, m, arguments.limit)
                for name in names
                if is_feasible(name, n, m, last.get(name))
            }
            last |= results
            plans = (results.get(name, "-") for name in UNREGULARISED)
            least = min((plan["cost"] for plan in plans if not isinstance(plan, str)), default=1.0)
            cells = [_cell(results.get(name, "-"), least) for name in names]
            print(f"| {n:,} → {m:,} | " + " | ".join(cells) + " |", flush=True)


def _cell(result: dict[str, float] | str, least: float) -> str:
    if isinstance(result, str):
        return result
    excess = 100.0 * (result["cost"] / least - 1.0)
    return f"{result['seconds']:.2f} s, {excess:+.2f} %, {result['memory']:.0f} MB"


if __name__ == "__main__":
    main()
