"""Compiled loops: what is kept of them on the disk is never out of date."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import pytest

import baker

ROOT = Path(baker.__file__).parent
MODULES = [
    ".".join(["baker", *path.relative_to(ROOT).with_suffix("").parts])
    for path in sorted(ROOT.rglob("*.py"))
    if "import compiled\n" in path.read_text()
]


@pytest.mark.parametrize("name", MODULES)
def test_machine_code_is_of_one_file(name: str) -> None:
    """numba does not see that another file changes, and would go on with its old code."""
    from numba.core.dispatcher import Dispatcher

    module = import_module(name)
    loops = [value for value in vars(module).values() if isinstance(value, Dispatcher)]
    assert loops
    assert {loop.py_func.__module__ for loop in loops} == {name}
