"""What brings a child process down is an exception here; it outlives neither its work nor us."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from baker import InputError, Options
from baker.cli import main
from baker.scans.child_process import ChildEnded, ChildProcess
from baker.scans.read import read_series
from tests.baker.conftest import write_las

ROOM = 1 << 30
UNGUARDED = """
import sys, baker
baker.bake(sys.argv[1], align="none").save(sys.argv[2])
"""


@pytest.fixture
def child():
    with ChildProcess() as child:
        yield child


def is_running(pid: int) -> bool:
    return subprocess.run(["ps", "-o", "stat=", "-p", str(pid)], capture_output=True).stdout[
        :1
    ] not in (b"", b"Z")


def test_returns_and_raises_what_the_function_does(child):
    np.testing.assert_array_equal(child.call(ROOM, np.arange, 5), np.arange(5))
    with pytest.raises(ZeroDivisionError, match="division"):
        child.call(ROOM, divmod, 1, 0)
    assert child.call(ROOM, os.getpid) not in (os.getpid(), None)


def test_its_end_is_an_exception_and_the_next_call_starts_another(child):
    first = child.call(ROOM, os.getpid)
    with pytest.raises(ChildEnded, match="by SIGABRT"):
        child.call(ROOM, os.abort)
    with pytest.raises(ChildEnded, match="with exit code 3"):
        child.call(ROOM, os._exit, 3)
    assert child.call(ROOM, os.getpid) != first


def test_what_a_function_prints_is_no_result(child):
    child.call(ROOM, os.system, "echo printed")
    assert child.call(ROOM, abs, -1) == 1


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere memory has no such limit")
def test_memory_is_limited_for_each_call(child):
    with pytest.raises(ChildEnded, match="GiB of memory"):
        child.call(1 << 28, np.ones, 1 << 25)
    assert len(child.call(ROOM, np.ones, 1 << 25)) == 1 << 25


def test_it_ends_with_us(child):
    pid = child.call(ROOM, os.getpid)
    child.__exit__()
    assert not is_running(pid)
    code = (
        "import os, signal; from baker.scans.child_process import ChildProcess\n"
        f"print(ChildProcess().call({ROOM}, os.getpid), flush=True)\n"
        "os.kill(os.getpid(), signal.SIGKILL)"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert found.returncode == -signal.SIGKILL
    until = time.monotonic() + 120.0
    while is_running(int(found.stdout)):
        assert time.monotonic() < until
        time.sleep(0.01)


def test_a_scan_that_brings_its_reader_down_is_named(tmp_path, capsys):
    folder = write_las(tmp_path / "scans")
    sound = (folder / "day01.laz").read_bytes()
    place = sound.index((50_000).to_bytes(4, "little"))
    lying = sound[:place] + (3_400_000_000).to_bytes(4, "little") + sound[place + 4 :]
    (folder / "day01.laz").write_bytes(lying)
    with pytest.raises(InputError, match=r"day01\.laz' is not a valid LAZ file, or is cut short"):
        read_series([folder], Options())
    assert main([str(folder), "-o", str(tmp_path / "p.gclip"), "-q"]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_workers_and_scripts_have_their_own(tmp_path, capsys):
    """Many plants' are in processes that may have no children of multiprocessing; a script may have
    no ``if __name__ == "__main__"``."""
    folder = write_las(tmp_path / "plants" / "a")
    words = [str(folder.parent), "-o", f"{tmp_path}/clips/", "--align", "none", "-q"]
    assert main(words) == 0, capsys.readouterr().err
    script, clip = tmp_path / "script.py", tmp_path / "b.gclip"
    script.write_text(UNGUARDED)
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[3])}
    subprocess.run([sys.executable, script, folder, clip], env=environment, check=True)
    assert clip.read_bytes() == (tmp_path / "clips" / "a.gclip").read_bytes()
