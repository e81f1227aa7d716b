"""Bakes and exports that are killed or stopped break nothing (at length: tests/kill.py)."""

import subprocess
import sys
from pathlib import Path


def test_what_is_killed_breaks_nothing_and_leaves_no_litter():
    command = [sys.executable, "-m", "tests.kill", "--count", "3", "--only", "cache,png"]
    root = Path(__file__).parents[1]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "6 SIGKILL, 6 SIGINT" in done.stdout.splitlines()[-1]
    assert "0 broken, 0 litter" in done.stdout.splitlines()[-1]
