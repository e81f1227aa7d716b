"""How many threads a bake may use."""

import os


def worker_count(asked: int) -> int:
    """`asked` threads, or where that is 0 as many as this process may use cores."""
    return asked or len(os.sched_getaffinity(0))
