"""Compile the solver before the first problem, and report progress."""

from collections.abc import Callable
from typing import Any

import numpy as np

from baker.transport.solve import solve


def compile_kernels(
    report_progress: Callable[[int, int], None] = lambda done, total: None,
) -> str | None:
    """Compile all functions of the exact solver, or load them from numba's cache.

    report_progress: called with (0, 1) if something has to be compiled, and (1, 1) after that.
    Returns a sentence for the user if compiled code can't be cached.
    """
    from numba.core.event import Listener, install_listener

    from baker.transport.network_simplex import network_simplex

    compiled = list[Any]()

    class FirstCompilation(Listener):
        def on_start(self, event: Any) -> None:
            if not compiled:
                report_progress(0, 1)
            compiled.append(event)

        def on_end(self, event: Any) -> None: ...

    with install_listener("numba:compile", FirstCompilation()):
        solve(np.eye(3), np.eye(3))
    if compiled:
        report_progress(1, 1)
    if network_simplex.stats.cache_path is None:  # type: ignore[attr-defined]
        return (
            "Compiled code can't be kept: there is no permission to write beside the program and "
            "in the user's cache folder. Every bake compiles it anew, for some seconds; "
            "NUMBA_CACHE_DIR may name another folder."
        )
    return None


if __name__ == "__main__":
    print(compile_kernels() or "The solver is compiled.")
