"""Compile functions with numba at their first call, and cache them for the next process."""

from collections.abc import Callable
from typing import TypeVar, cast

from gclip.errors import UserError

Function = TypeVar("Function", bound=Callable)


def compiled(function: Function) -> Function:
    """Decorate a function to be compiled at its first call and to release the GIL.

    Importing numba takes a quarter of a second: import the modules that use this in functions.
    Raises UserError if the environment disables compilation.
    """
    from numba import config, njit

    if config.DISABLE_JIT:  # type: ignore[attr-defined]
        raise UserError(
            "NUMBA_DISABLE_JIT is set in the environment; unset it to have loops compiled."
        )
    try:
        return cast(Function, njit(function, nogil=True, cache=True))
    except RuntimeError:  # no folder for the cache can be written
        return cast(Function, njit(function, nogil=True))
