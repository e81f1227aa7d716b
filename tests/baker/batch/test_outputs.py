"""Whether outputs can be written is known before the work; what is there is kept unless forced."""

import os
import re

import pytest

from baker.batch import plant
from baker.batch.outputs import check_output
from baker.cli import main
from gclip.errors import UserError


@pytest.mark.parametrize("name", ["a.txt", "folder.gclip", "missing/a.gclip", "file/a.gclip"])
def test_names_that_cannot_be_written_are_refused(tmp_path, name):
    (tmp_path / "folder.gclip").mkdir()
    (tmp_path / "file").touch()
    with pytest.raises(UserError, match=name):
        check_output(tmp_path / name, True, "a clip", ".gclip")


def test_what_is_there_is_kept_unless_forced(tmp_path):
    path = tmp_path / "a.gclip"
    check_output(path, False, "a clip", ".gclip")
    path.touch()
    check_output(path, True, "a clip", ".gclip")
    with pytest.raises(UserError, match=f"{re.escape(str(path))} exists; --force overwrites it."):
        check_output(path, False, "a clip", ".gclip")


def test_of_two_bakes_at_once_the_slower_one_overwrites_nothing(
    write_scans, tmp_path, monkeypatch, capsys
):
    path, bake = tmp_path / "plant.gclip", plant.bake_recorded

    def bake_slowly(*arguments, **named):
        clip, survey = bake(*arguments, **named)
        path.write_text("the other's")
        return clip, survey

    monkeypatch.setattr(plant, "bake_recorded", bake_slowly)
    words = [str(write_scans(days=(0, 1))), "-o", str(path), "-q", "--align", "none"]
    assert main(words) == 2
    assert capsys.readouterr().err == f"bake: {path} exists; --force overwrites it.\n"
    assert path.read_text() == "the other's"
    assert {entry.name for entry in tmp_path.iterdir()} == {"scans", "plant.gclip"}
    assert main([*words, "--force"]) == 0
    assert path.read_bytes() != b"the other's"


def test_a_folder_that_nothing_may_be_written_into_is_refused(tmp_path, monkeypatch):
    check_output(tmp_path / "a.gclip", False, "a clip", ".gclip")
    monkeypatch.setattr(os, "access", lambda path, mode: mode != os.W_OK)  # as for another user
    with pytest.raises(UserError, match=f"{tmp_path}: permission denied to write into this folder"):
        check_output(tmp_path / "a.gclip", True, "a clip", ".gclip")


@pytest.mark.parametrize("cache", ["p.gclip", "p.html/kept", "../{}/t.csv"])
def test_a_cache_where_a_file_goes_is_refused_before_the_work(write_scans, tmp_path, capsys, cache):
    outputs = ["-o", tmp_path / "p.gclip", "--report", tmp_path / "p.html", "--traits"]
    folder = tmp_path / cache.format(tmp_path.name)
    words = [write_scans(), *outputs, tmp_path / "t.csv", "--cache", folder]
    assert main([str(word) for word in words]) == 2
    assert re.fullmatch(r"bake: --cache .* name a folder\.\n", capsys.readouterr().err)
    assert [path.name for path in tmp_path.iterdir()] == ["scans"]


def test_a_cache_that_links_to_itself_is_said(write_scans, tmp_path, capsys):
    loop = tmp_path / "loop"
    loop.symlink_to(loop)
    words = [write_scans(), "-o", tmp_path / "p.gclip", "--cache", loop, "-q"]
    assert main([str(word) for word in words]) == 2
    assert capsys.readouterr().err == f"bake: {loop} can't be a cache: File exists.\n"
