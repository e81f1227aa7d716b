"""What holds for all tests."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

# One thread for linear algebra, as the commands have it: more would spin while they wait for each
# other, and tests run side by side on all cores anyway.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

# How long a case takes never decides whether a test passes.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")


@pytest.fixture(scope="session", autouse=True)
def default_signals_for_children() -> Iterator[None]:
    """Let child processes be interrupted where the tests themselves are not, as under ``nohup``.

    A new program inherits ignored signals as ignored, but handled ones as their default. So a
    handler that does nothing stands where a signal was ignored.
    """
    numbers = [getattr(signal, name, None) for name in ("SIGINT", "SIGTERM", "SIGHUP")]
    ignored = [n for n in numbers if n is not None and signal.getsignal(n) is signal.SIG_IGN]
    for number in ignored:
        signal.signal(number, lambda number, frame: None)
    yield
    for number in ignored:
        signal.signal(number, signal.SIG_IGN)


@pytest.fixture(scope="session")
def chromium() -> str:
    """Path of a Chromium: playwright's own where it has been downloaded, else the system's.

    One from a snap is passed over: it sees neither /tmp nor hidden folders.
    """
    from playwright.sync_api import sync_playwright

    with sync_playwright() as control:
        own = control.chromium.executable_path
    found = (own, shutil.which("chromium"), shutil.which("google-chrome"))
    for program in found:
        if program and Path(program).exists() and "/snap/" not in program:
            return program
    pytest.skip("no Chromium (apt-get install chromium, or python -m playwright install chromium)")


@pytest.fixture(scope="module")
def display() -> Iterator[dict[str, str]]:
    """A screen that nobody sees: the variables of the environment that lead to it."""
    for program in ("Xvfb", "xdotool"):
        if shutil.which(program) is None:
            pytest.skip(f"{program} is not installed (apt-get install xvfb xdotool)")
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", "1", "-screen", "0", "1280x960x24", "-noreset"],
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
    )  # fmt: skip
    assert server.stdout is not None
    number = server.stdout.readline().strip()
    yield {"DISPLAY": f":{number}", "WAYLAND_DISPLAY": "", "XDG_SESSION_TYPE": "x11"}
    server.terminate()
    server.wait(timeout=120)
