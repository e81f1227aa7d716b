"""Compile functions with numba at their first call, and cache them for the next process."""

from collections.abc import Callable
from typing import TypeVar, cast

from numba import config, njit

from baker.errors import InputError

Function = TypeVar("Function", bound=Callable)


def compiled(function: Function) -> Function:
    """Decorate a function to be compiled at its first call and to release the GIL."""
    if config.DISABLE_JIT:  # type: ignore[attr-defined]
        raise InputError("NUMBA_DISABLE_JIT is set in the environment; unset it.")
    try:
        return cast(Function, njit(function, nogil=True, cache=True))
    except RuntimeError:  # no folder for the cache can be written
        return cast(Function, njit(function, nogil=True))
