"""A stop signal ends a command at once, wherever it is, and no draft is left."""

from __future__ import annotations

import gzip
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from gclip.terminal.command import run

STOPPED = "bake: stopped; nothing half-written is left behind.\n"
COMMAND = """
import os, signal, sys, tempfile, threading, time
from pathlib import Path
from gclip.terminal import atomic
from gclip.terminal.command import run_app
import typer

app = typer.Typer()

def ctrl_c():
    signal.raise_signal(signal.SIGINT)

@app.command()
def main() -> None:
{work}
    time.sleep(60)
    print("not stopped")

sys.argv[1:] = []
signal.signal(signal.SIGINT, signal.default_int_handler)
sys.exit(run_app(app, "bake"))
"""


def stopped(work: str, folder: Path, code: int = 130) -> str:
    """Run a command that does this until it stops; what it writes to stderr."""
    lines = "\n".join(f"    {line}" for line in work.splitlines())
    command = [sys.executable, "-c", COMMAND.replace("{work}", lines)]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, [*sys.path, folder]))}
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=50
    )
    assert (done.returncode, done.stdout) == (code, ""), done.stderr
    return done.stderr


def test_an_object_being_deleted_does_not_keep_it_from_stopping(tmp_path: Path) -> None:
    work = "class Dropped:\n    def __del__(self):\n        ctrl_c()\nDropped()"
    assert stopped(work, tmp_path) == STOPPED


def test_nor_does_a_module_that_catches_all_exceptions(tmp_path: Path) -> None:
    (tmp_path / "catches.py").write_text(
        "import signal\n"
        "try:\n    signal.raise_signal(signal.SIGINT)\nexcept BaseException:\n    pass\n"
    )
    assert stopped("import catches", tmp_path) == STOPPED


@pytest.mark.parametrize("place", ["os.mkdir", "os.open", "Path.write_text"])
def test_no_draft_is_left(tmp_path: Path, place: str) -> None:
    """Also where the signal comes when the folder has just been made."""
    holder, name = place.split(".")
    work = f"""
usual = {place}
def stopping(*arguments, **named):
    result = usual(*arguments, **named)
    if ".part" in str(arguments[0]):
        ctrl_c()
    return result
{holder}.{name} = stopping
with atomic.atomic_file(Path("plant.gclip")) as part:
    part.write_text("half")
    os.close(os.open(part, os.O_RDONLY))
"""
    (tmp_path / "plant.gclip").write_text("old")
    assert stopped(work, tmp_path) == STOPPED
    assert [path.name for path in tmp_path.iterdir()] == ["plant.gclip"]
    assert (tmp_path / "plant.gclip").read_text() == "old"


def test_no_unpacked_scan_is_left(tmp_path: Path) -> None:
    with gzip.open(tmp_path / "scan.xyz.gz", "wt") as scan:
        scan.write("0 0 0\n1 1 1\n")
    (tmp_path / "temporary").mkdir()
    work = """
from baker.scans import formats
formats.require_no_bomb = lambda *_: ctrl_c()
tempfile.tempdir = "temporary"
formats.read_columns(Path("scan.xyz.gz"))
"""
    assert stopped(work, tmp_path) == STOPPED
    assert not any((tmp_path / "temporary").iterdir())


def test_threads_that_go_on_writing_leave_nothing(tmp_path: Path) -> None:
    work = """
def write(folder, name):
    while True:
        (folder / name).write_text("x" * 9)
        (folder / name).unlink()
with atomic.folder_beside(Path("plant.gclip")) as folder:
    for name in "abcd":
        threading.Thread(target=write, args=(folder, name), daemon=True).start()
    time.sleep(0.3)
    ctrl_c()
"""
    assert STOPPED in stopped(work, tmp_path)
    assert not any(tmp_path.iterdir())


def test_the_signal_decides_the_exit_code(tmp_path: Path) -> None:
    assert stopped("signal.raise_signal(signal.SIGTERM)", tmp_path, 143) == STOPPED


def test_signals_that_were_ignored_from_the_start_stay_ignored(tmp_path: Path) -> None:
    code = COMMAND.replace("{work}", "    signal.raise_signal(signal.SIGHUP)").replace("60", "0")
    command = ["nohup", sys.executable, "-c", code]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, "not stopped\n"), done.stderr


def test_commands_called_from_python_are_interrupted_as_usual(
    capsys: pytest.CaptureFixture[str],
) -> None:
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        assert run("bake", lambda: signal.raise_signal(signal.SIGINT)) == 130
    finally:
        signal.signal(signal.SIGINT, before)
    assert capsys.readouterr().err == STOPPED
