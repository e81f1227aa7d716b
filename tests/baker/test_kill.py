"""A bake that is killed: the old output is intact or the new one whole (all: tests/kill.py)."""

import subprocess
import sys
from pathlib import Path


def test_killed_bakes_break_nothing_and_leave_no_litter():
    command = [sys.executable, "-m", "tests.kill", "--count", "3", "--only", "cache"]
    root = Path(__file__).parents[2]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "0 broken, 0 litter" in done.stdout.splitlines()[-1]
