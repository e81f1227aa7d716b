"""Outputs appear whole or not at all."""

import errno
import os
import subprocess
import sys
import threading

import pytest

from gclip.errors import UserError
from gclip.terminal.atomic import atomic_file, folder_beside, writing


def test_what_a_killed_process_left_is_no_trouble(tmp_path):
    code = (
        "import os, sys; from pathlib import Path; from gclip.terminal.atomic import atomic_file\n"
        "with atomic_file(Path(sys.argv[1])) as part:\n"
        "    part.write_text('half')\n"
        "    os.kill(os.getpid(), 9)"
    )
    subprocess.run([sys.executable, "-c", code, str(tmp_path / "out")])
    (left,) = tmp_path.iterdir()
    with atomic_file(tmp_path / "out") as part:
        part.write_text("mine")
    assert (tmp_path / "out").read_text() == "mine"
    assert {*tmp_path.iterdir()} == {left, tmp_path / "out"}


@pytest.mark.parametrize("name", ["n" * 255, "🌱" * 63])
def test_names_may_be_as_long_as_the_system_allows(tmp_path, name):
    with atomic_file(tmp_path / name) as part:
        part.write_text("mine")
    assert (tmp_path / name).read_text() == "mine"


def test_an_error_leaves_the_old_file(tmp_path):
    path = tmp_path / "out"
    path.write_text("old")
    with pytest.raises(ValueError, match="no"), atomic_file(path) as part:  # noqa: PT012
        part.write_text("new")
        raise ValueError("no")
    assert [p.name for p in tmp_path.iterdir()] == ["out"]
    assert path.read_text() == "old"


def test_many_at_once_do_not_harm_each_other(tmp_path):
    wrong = []

    def write(number: int) -> None:
        for _ in range(20):
            with folder_beside(tmp_path / "out") as folder:
                (folder / "a").write_text(str(number))
                if (folder / "a").read_text() != str(number):
                    wrong.append(number)

    threads = [threading.Thread(target=write, args=(n,)) for n in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("mask", [0o022, 0o077])
def test_files_are_as_open_as_any(tmp_path, mask):
    before = os.umask(mask)
    try:
        with atomic_file(tmp_path / "file") as part:
            part.touch(0o600)
    finally:
        os.umask(before)
    assert (tmp_path / "file").stat().st_mode & 0o777 == 0o666 & ~mask


def test_memory_that_runs_out_is_not_said_of_the_file(tmp_path):
    with (
        pytest.raises(UserError, match="out can't be written: No space left"),
        writing(tmp_path / "out"),
    ):
        raise OSError(errno.ENOSPC, "No space left")
    with pytest.raises(OSError, match="Cannot allocate"), writing(tmp_path / "out"):
        raise OSError(errno.ENOMEM, "Cannot allocate memory")
