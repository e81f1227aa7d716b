"""Loops as machine code, compiled by numba at their first call and kept for the next process."""

import os
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import TypeVar, cast

Function = TypeVar("Function", bound=Callable)

BESIDE = Path(__file__).parent / "__pycache__"
ROOM = 2 * 2**20  # bytes: twice what the compiled code of all loops takes


def compiled(function: Function) -> Function:
    """The function, compiled at its first call; it then runs without Python's global lock.

    Importing numba takes a quarter of a second: import modules that use this late.
    """
    from numba import config, njit

    folder = code_folder()
    if folder is None:
        return cast(Function, njit(function, nogil=True))
    if folder != BESIDE:
        config.CACHE_DIR = str(folder)  # type: ignore[attr-defined]
    return cast(Function, njit(function, nogil=True, cache=True))


@cache
def code_folder() -> Path | None:
    """Where compiled code is kept; None where no folder can hold it.

    The folder that NUMBA_CACHE_DIR names, if it is set; else `__pycache__` beside this module, or
    the user's cache folder where that can't be written to.
    """
    from platformdirs import user_cache_path

    named = os.environ.get("NUMBA_CACHE_DIR")
    folders = [Path(named)] if named else [BESIDE, user_cache_path("numba")]
    return next((folder for folder in folders if _can_hold_code(folder)), None)


def _can_hold_code(folder: Path) -> bool:
    if any(folder.rglob("network_simplex.*.nbi")):
        return True
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as file:
            file.write(bytes(ROOM))
    except OSError:
        return False
    return True
