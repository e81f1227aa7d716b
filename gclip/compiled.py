"""Loops as machine code, compiled by numba at their first call and kept for the next process."""

from collections.abc import Callable
from typing import TypeVar, cast

Function = TypeVar("Function", bound=Callable)


def compiled(function: Function) -> Function:
    """The function, compiled at its first call; it then runs without Python's global lock.

    Importing numba takes a quarter of a second: import modules that use this late.
    """
    from numba import njit

    try:
        return cast(Function, njit(function, nogil=True, cache=True))
    except RuntimeError:  # neither beside the module nor in the user's cache folder can it be kept
        return cast(Function, njit(function, nogil=True))
