"""Loops of our own as machine code, compiled by numba on first use and kept for the next run."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

Function = TypeVar("Function", bound=Callable)


def compiled(function: Function) -> Function:
    """The function, compiled on its first call; it then runs without Python's global lock.

    The machine code is kept beside the module, or in the user's cache folder; where neither can be
    written to, every process compiles for itself. Importing numba takes a quarter of a second:
    import modules that use this late.
    """
    from numba import njit

    try:
        return cast(Function, njit(function, nogil=True, cache=True))
    except RuntimeError:  # no folder to keep it in
        return cast(Function, njit(function, nogil=True))
