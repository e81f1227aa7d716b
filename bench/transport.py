"""Solvers of the transport problem of one segment: seconds, cost and memory.

    python -m bench.transport [--sizes 500,...,500000] [--only NAME,...] [--limit SECONDS]

A leaf grows by half of its length, bends, and is scanned again. For every size N there are two
problems: N + 1 and 3N/2 points, and N and N points. All masses are uniform, all costs are squared
distances. Each solver runs in a process of its own, which is stopped after `--limit` seconds; the
solver is not tried on larger problems then, nor where its dense matrix would not fit ("-").

seconds Of processor time of all threads, since other work may go on beside.
cost    Above the least cost of an unregularised plan found for the problem, in percent. Sinkhorn
        iterations trade cost for smoothness, or stop before the marginals are met (below zero);
        GeomLoss returns no plan, so its value is compared, which includes the entropy.
memory  The peak of the process above that before the solver was called, in MB.

Peers that are not installed are skipped by name:

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
from baker.transport.sinkhorn import nearest, unique
from baker.transport.solve import solve

SIZES = "500,1000,2000,5000,10000,20000,50000,100000,200000,500000"
SPARSE_NEIGHBORS = 20
PART_SIZE = 1000  # points of a part that hierarchical refinement solves with emd
MEMORY_PER_PAIR = 40  # bytes that the dense solvers take at least
DENSE = ("POT emd", "POT sinkhorn")
UNREGULARISED = ("bake", "POT emd", "POT emd, sparse", "hierarchical")

Cloud = NDArray[np.float64]
Solver = Callable[[Cloud, Cloud], float]


def leaf(count: int, length: float, seed: int) -> Cloud:
    """Points of a bent leaf with the noise of a scanner."""
    random = np.random.default_rng(seed)
    along, across = random.random(count), random.random(count) - 0.5
    width = 0.3 * length * np.sin(np.pi * along)
    points = np.stack(
        [along * length, across * width, 0.3 * length * np.sin(2.0 * along * length**0.3)], axis=1
    )
    return points + random.normal(scale=0.002, size=points.shape)


def problem(n: int, m: int) -> tuple[Cloud, Cloud]:
    return leaf(n, 1.0, 2 * n), leaf(m, 1.5, 2 * n + 1)


def ours(**options: Any) -> Solver:
    return lambda start, end: solve(start, end, TransportOptions(**options)).cost


def pot_emd(start: Cloud, end: Cloud) -> float:
    from ot.lp import emd

    return emd(*_uniform(start, end), _squared_distances(start, end), 10**9, log=True)[1]["cost"]


def pot_sparse(start: Cloud, end: Cloud) -> float:
    from ot.lp import emd
    from scipy.sparse import coo_matrix

    plan = solve(start, end)
    moves = plan.mass[:, None] * (end[plan.columns] - start[plan.rows])
    shift = np.stack([np.bincount(plan.rows, axis, len(start)) for axis in moves.T], axis=1)
    near = nearest(start + len(start) * shift, end, SPARSE_NEIGHBORS)
    pairs = unique(near, (plan.rows, plan.columns))
    matrix = coo_matrix((costs(start, end, pairs, 2), pairs), shape=(len(start), len(end)))
    found = emd(*_uniform(start, end), matrix, numItermax=10**9, check_marginals=False).tocoo()
    return float(found.data @ costs(start, end, (found.row, found.col), 2))


def pot_sinkhorn(start: Cloud, end: Cloud) -> float:
    from ot.bregman import sinkhorn_log

    cost = _squared_distances(start, end)
    regularization = 0.05 * np.median(cost)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it has not converged
        plan = sinkhorn_log(*_uniform(start, end), cost, regularization, 500, stopThr=1e-3)
    return float((plan * cost).sum())


def geomloss(start: Cloud, end: Cloud) -> float:
    import torch
    from geomloss import SamplesLoss

    spacing = 0.5 / np.sqrt(len(start))  # of points on a leaf of an area of about 0.2
    loss = SamplesLoss(
        "sinkhorn", p=2, blur=spacing / 2, scaling=0.8, debias=False, backend="multiscale"
    )
    # Its cost is half of the squared distance.
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


def run_here(name: str, n: int, m: int) -> dict[str, float]:
    """Solve one problem in this process; the solver's imports and compilation are not timed."""
    SOLVERS[name](*problem(40, 40))
    start, end = problem(n, m)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    began = time.process_time()
    cost = SOLVERS[name](start, end)
    seconds = time.process_time() - began
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return {"seconds": seconds, "cost": cost, "memory": (peak - before) / 1e3}


def run(name: str, n: int, m: int, limit: float) -> dict[str, float] | str:
    """Solve one problem in a process of its own; or the reason why there is no result."""
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
    """Whether to try a problem, given the result of the same solver on a smaller one."""
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
    parser.add_argument("--limit", type=float, default=300.0, help="seconds, by the clock")
    parser.add_argument("--run", default="", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    sizes = [int(size) for size in arguments.sizes.split(",")]
    if arguments.run:
        print(json.dumps(run_here(arguments.run, *sizes)))
        return
    chosen = arguments.only.split(";") if arguments.only else [*SOLVERS]
    names = [name for name in SOLVERS if name in chosen]
    print("| points | " + " | ".join(names) + " |\n|" + "---|" * (len(names) + 1))
    last: dict[str, dict[str, float] | str] = {}
    for size in sizes:
        for n, m in ((size + 1, size * 3 // 2), (size, size)):
            found = {
                name: run(name, n, m, arguments.limit)
                for name in names
                if is_feasible(name, n, m, last.get(name))
            }
            last |= found
            plans = (found.get(name, "-") for name in UNREGULARISED)
            least = min((each["cost"] for each in plans if not isinstance(each, str)), default=1.0)
            cells = [_cell(found.get(name, "-"), least) for name in names]
            print(f"| {n:,} → {m:,} | " + " | ".join(cells) + " |", flush=True)


def _cell(result: dict[str, float] | str, least: float) -> str:
    if isinstance(result, str):
        return result
    above = 100.0 * (result["cost"] / least - 1.0)
    return f"{result['seconds']:.2f} s, {above:+.2f} %, {result['memory']:.0f} MB"


if __name__ == "__main__":
    main()
