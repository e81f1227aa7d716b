"""Compile functions with numba at their first call, and cache them for the next process."""

from collections.abc import Callable
from typing import TypeVar, cast

Function = TypeVar("Function", bound=Callable)


def compiled(function: Function) -> Function:
    """Decorate a function to be compiled at its first call and to release the GIL.

    Importing numba takes a quarter of a second: import the modules that use this in functions.
    """
    from numba import njit

    try:
        return cast(Function, njit(function, nogil=True, cache=True))
    except RuntimeError:  # no folder for the cache can be written
        return cast(Function, njit(function, nogil=True))
