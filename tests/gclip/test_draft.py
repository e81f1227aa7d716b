"""Drafts: outputs appear whole, and only what the dead have left is removed."""

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from gclip.draft import draft_file, draft_folder, replace_folder

HOLD = """
import sys, time
from pathlib import Path
from gclip.draft import draft_folder
with draft_folder(Path(sys.argv[1])) as folder:
    (folder / "part").write_text("half")
    print(folder, flush=True)
    time.sleep(60)
"""


@pytest.fixture
def other(tmp_path):
    """Another process that is writing `tmp_path / "out"`, and its draft."""
    process = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(tmp_path / "out")], stdout=subprocess.PIPE, text=True
    )
    yield process, Path(process.stdout.readline().strip())
    process.kill()
    process.communicate()


def test_a_living_draft_is_left_alone_and_a_dead_one_removed(tmp_path, other):
    process, draft = other
    with draft_file(tmp_path / "out") as part:
        part.write_text("mine")
    assert draft.is_dir()
    process.send_signal(signal.SIGKILL)
    process.wait()
    with draft_file(tmp_path / "another") as part:
        part.write_text("not the same output")
    assert draft.is_dir()
    with draft_file(tmp_path / "out") as part:
        part.write_text("mine again")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["another", "out"]
    assert (tmp_path / "out").read_text() == "mine again"


def test_what_only_looks_like_a_draft_stays(tmp_path):
    names = [".out.part", ".out.x", "out.x.part", ".outer.x.part", ".out.file.part"]
    for name in names[:-1]:
        (tmp_path / name).mkdir()
    (tmp_path / names[-1]).write_text("a file")
    (tmp_path / ".out.link.part").symlink_to(tmp_path)
    with draft_file(tmp_path / "out") as part:
        part.write_text("")
    assert {path.name for path in tmp_path.iterdir()} == {*names, "out", ".out.link.part"}


def test_an_error_leaves_the_old_file(tmp_path):
    path = tmp_path / "out"
    path.write_text("old")
    with pytest.raises(ValueError, match="no"), draft_file(path) as part:  # noqa: PT012
        part.write_text("new")
        raise ValueError("no")
    assert [p.name for p in tmp_path.iterdir()] == ["out"]
    assert path.read_text() == "old"


def test_many_at_once_do_not_harm_each_other(tmp_path):
    wrong = []

    def write(number: int) -> None:
        for _ in range(20):
            with draft_folder(tmp_path / "out") as folder:
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
def test_files_and_folders_are_as_open_as_any(tmp_path, mask):
    before = os.umask(mask)
    try:
        with draft_file(tmp_path / "file") as part:
            part.touch(0o600)
        with draft_folder(tmp_path / "folder") as draft:
            assert replace_folder(draft, tmp_path / "folder")
    finally:
        os.umask(before)
    assert (tmp_path / "file").stat().st_mode & 0o777 == 0o666 & ~mask
    assert (tmp_path / "folder").stat().st_mode & 0o777 == 0o777 & ~mask


def test_a_folder_is_replaced_at_once_and_keeps_what_else_is_in_it(tmp_path):
    home = tmp_path / "frames"
    home.mkdir()
    (home / "0").write_text("old")
    (home / "notes").write_text("mine")
    with draft_folder(home) as draft:
        (draft / "0").write_text("new")
        if not replace_folder(draft, home):
            pytest.skip("this file system can't exchange two folders")
    assert {path.name: path.read_text() for path in home.iterdir()} == {"0": "new", "notes": "mine"}
    assert list(tmp_path.iterdir()) == [home]
