"""Progress harms neither the work nor the workers."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from gclip.terminal.progress import StageProgress

FORK = """
import os, sys, warnings
from gclip.terminal.progress import StageProgress
with StageProgress() as progress:
    progress("working", 0, 1)
    assert sys.stderr is sys.__stderr__ and sys.stdout is sys.__stdout__
    progress._console._lock.acquire()  # as when it is drawing in its thread
    child = os.fork()
    if child == 0:
        warnings.warn("something")
        os._exit(7)
    progress._console._lock.release()
    sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="a system without fork")
def test_a_forked_worker_can_print_a_warning() -> None:
    """While bars are on a terminal, whose lock the fork would wait for in vain."""
    import pty

    pid, terminal = pty.fork()
    if pid == 0:
        os.execv(sys.executable, [sys.executable, "-c", FORK])
    shown = b""
    try:
        while chunk := os.read(terminal, 1000):
            shown += chunk
    except OSError:
        pass  # the terminal of a process that has ended
    os.close(terminal)
    assert os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == 7, shown.decode()
    assert b"something" in shown


@pytest.mark.parametrize("out", ["gone", "full", "closed"])
def test_what_nobody_can_take_is_not_said(out: str) -> None:
    code = (
        f"import os, sys; {out!r} == 'closed' and (os.close(2), setattr(sys, 'stderr', None))\n"
        "from gclip.terminal.progress import StageProgress\n"
        "with StageProgress(False) as progress:\n"
        "    for _ in range(5): progress.say('x' * 1000)\n"
        "print('done')"
    )
    reading, writing = os.pipe()
    os.close(reading)
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-c", code],
            stdout=subprocess.PIPE,
            stderr=full if out == "full" else writing,
        )
    os.close(writing)
    assert (done.returncode, done.stdout) == (0, b"done\n")


def test_lines_take_the_bars_place_in_a_pipe(capsys: pytest.CaptureFixture[str]) -> None:
    with StageProgress(False) as progress:
        assert progress.plain
        progress.say("a\x1b[2Jb")
    with StageProgress(True) as progress:
        assert not progress.plain
        progress.say("nothing")
    assert capsys.readouterr().err == "a\ufffd[2Jb\n"
