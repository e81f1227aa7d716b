"""Compiled loops: what is kept of them on the disk is never out of date."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from shutil import copytree, ignore_patterns

import pytest

import baker

ROOT = Path(baker.__file__).parent
MODULES = [
    ".".join(path.relative_to(ROOT.parent).with_suffix("").parts)
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


COMPILE = """
from baker.transport.compile import compile_kernels
reported = []
sentence = compile_kernels(lambda done, total: reported.append((done, total)))
print(repr((reported, sentence)))
"""


def test_a_bake_whose_code_can_not_be_kept_says_so_and_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    source = tmp_path / "source"
    copytree(ROOT, source / "baker", ignore=ignore_patterns("__pycache__"))
    (source / "baker" / "transport" / "__pycache__").touch()
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(source), str(ROOT.parent)]))
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "file"))
    command = [sys.executable, "-c", COMPILE]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    reported, sentence = ast.literal_eval(done.stdout)
    assert reported == [(0, 1), (1, 1)]
    assert "NUMBA_CACHE_DIR" in sentence


SOLVE = """
from importlib import import_module
import sys
import numpy as np
from numba.core.dispatcher import Dispatcher
from baker.transport.compile import compile_kernels
from baker.transport.problem import TransportOptions
from baker.transport.solve import solve

compile_kernels()
random = np.random.default_rng(0)
for n, m, options in ((300, 200, {}), (4000, 30, {}), (2000, 2100, {}), (90, 80, {"power": 1})):
    for kind in (np.float32, np.float64):
        start, end = random.random((n, 3)).astype(kind), random.random((m, 3)).astype(kind)
        solve(start, end, TransportOptions(**options))
for name in sys.argv[1:]:
    for loop in vars(import_module(name)).values():
        if isinstance(loop, Dispatcher):
            print(loop.py_func.__name__, len(loop.signatures))
"""


def test_every_loop_is_compiled_for_one_set_of_types() -> None:
    """In a process of its own, where no other test has called a loop."""
    command = [sys.executable, "-c", SOLVE, *MODULES]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    counts = dict(line.split() for line in done.stdout.splitlines())
    assert counts
    assert set(counts.values()) <= {"0", "1"}, counts
