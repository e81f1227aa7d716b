"""One segment with nothing to split it by: `python -m bench.one_segment [--sizes 300000,500000]`.

A leaf that grows by half and bends, scanned anew, is transported as one problem. Against our plan
stand the best plans that other ways find within `--limit` seconds each, in processes of their own:

    ours, large cells   our solver with cells 64 times as large and sweeps until nothing is gained
    POT                 emd on our plan's pairs and each point's nearest 20 partners of our plan's
                        own warp

Printed are seconds and the cost above the best plan found by anyone: of the whole squared distance,
and of what is left of it when the best linear map is taken out, which is all that solvers decide.
"""

from __future__ import annotations

import argparse
import multiprocessing
import time
from collections.abc import Callable
from queue import Empty
from typing import Any

import numpy as np

from baker.transport import multiscale
from baker.transport.problem import TransportOptions, costs
from baker.transport.solve import solve
from baker.transport.support import balance, explained_cost, nearest, unique
from bench.transport import Cloud, leaf

NEAREST = 20


def ours(start: Cloud, end: Cloud, workers: int) -> float:
    return solve(start, end, TransportOptions(workers=workers)).cost


def large_cells(start: Cloud, end: Cloud, workers: int) -> float:
    multiscale.POINTS_OF_CELL = multiscale.POINTS_OF_CELL_IF_TIGHT = 64_000
    multiscale.MAX_SWEEPS, multiscale.MIN_GAIN = 20, 1e-6
    return ours(start, end, workers)


def _support(start: Cloud, end: Cloud, workers: int) -> tuple[Cloud, Cloud, Any, Any]:
    """The balanced clouds, the pairs that the libraries may use, and their costs."""
    plan = solve(start, end, TransportOptions(workers=workers))
    here, there = balance(start, end)
    way = plan.mass[:, None] * (there[plan.columns] - here[plan.rows])
    shift = np.stack([np.bincount(plan.rows, axis, len(here)) for axis in way.T], axis=1)
    pairs = unique(nearest(here + len(here) * shift, there, NEAREST), (plan.rows, plan.columns))
    return here, there, pairs, costs(here, there, pairs, 2)


def pot(start: Cloud, end: Cloud, workers: int) -> float:
    from ot.lp import emd
    from scipy.sparse import coo_matrix

    here, there, pairs, cost = _support(start, end, workers)
    masses = [np.full(len(side), 1.0 / len(side)) for side in (start, end)]
    matrix = coo_matrix((cost, pairs), shape=(len(start), len(end)))
    plan = emd(*masses, matrix, numItermax=10**9, check_marginals=False).tocoo()
    left = float(plan.data @ costs(here, there, (plan.row, plan.col), 2))
    return left + explained_cost(start, end, here, there)


def within(limit: float, way: Callable[..., float], *given: Any) -> tuple[float, float] | None:
    """Seconds and cost of a way, or None where it took longer than the limit or failed."""
    context = multiprocessing.get_context("spawn")
    found: Any = context.Queue()
    process = context.Process(target=_timed, args=(found, way, *given))
    process.start()
    try:
        return found.get(timeout=limit)
    except Empty:
        return None
    finally:
        process.terminate()
        process.join()


def _timed(found: Any, way: Callable[..., float], *given: Any) -> None:
    solve(leaf(40, 1.0, 0), leaf(50, 1.0, 1))  # imports and compiled code are not timed
    began = time.perf_counter()
    cost = way(*given)
    found.put((time.perf_counter() - began, cost))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", default="300000,500000", help="points before and after")
    parser.add_argument("--limit", type=float, default=600.0, help="seconds for each way")
    parser.add_argument("--workers", type=int, default=2)
    arguments = parser.parse_args()
    n, m = map(int, arguments.sizes.split(","))
    start, end = leaf(n, 1.0, 0), leaf(m, 1.5, 1)
    explained = explained_cost(start, end, *balance(start, end))
    ways = {"ours": ours, "ours, large cells": large_cells, "POT": pot}
    results = {
        name: within(arguments.limit, way, start, end, arguments.workers)
        for name, way in ways.items()
    }
    best = min(result[1] for result in results.values() if result)
    print(f"{n:,} to {m:,} points; above the best plan: whole cost, what a linear map leaves")
    for name, result in results.items():
        if result is None:
            print(f"{name:<20}none within {arguments.limit:.0f} s")
            continue
        seconds, cost = result
        left = (cost - best) / (best - explained)
        print(f"{name:<20}{seconds:>8.1f} s{100 * (cost / best - 1):>10.4f} %{100 * left:>10.3f} %")


if __name__ == "__main__":
    main()
