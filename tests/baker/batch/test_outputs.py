"""Whether outputs can be written is known before the work; what is there is kept unless forced."""

import os
import re

import pytest

from baker.batch import plant
from baker.batch.command import check_output
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
    path, bake = tmp_path / "plant.gclip", plant.bake_with_survey

    def bake_slowly(*arguments, **named):
        clip, survey = bake(*arguments, **named)
        path.write_text("the other's")
        return clip, survey

    monkeypatch.setattr(plant, "bake_with_survey", bake_slowly)
    words = [str(write_scans(days=(0, 1))), "-o", str(path), "-q", "--align", "none"]
    assert main(words) == 2
    assert capsys.readouterr().err == f"bake: {path} exists; --force overwrites it.\n"
    assert path.read_text() == "the other's"
    assert {entry.name for entry in tmp_path.iterdir()} == {"scans", "plant.gclip"}
    assert main([*words, "--force"]) == 0
    assert path.read_bytes() != b"the other's"


def test_a_folder_that_nothing_may_be_written_into_is_refused(tmp_path, monkeypatch):
    check_output(tmp_path / "a.gclip", False, "a clip", ".gclip")

    def refuse(*path: object) -> None:  # as for another user
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "mkdir", refuse)
    with pytest.raises(UserError, match=r"a\.gclip can't be written: Permission denied\.$"):
        check_output(tmp_path / "a.gclip", True, "a clip", ".gclip")


def test_a_cache_where_a_file_goes_is_refused_before_the_work(write_scans, tmp_path, capsys):
    out = tmp_path / "p.gclip"
    words = [write_scans(), "-o", out, "--cache", out / "kept"]
    assert main([str(word) for word in words]) == 2
    assert capsys.readouterr().err == f"bake: {out} is a folder; a file's name is needed.\n"


def test_the_clip_of_one_plants_files_is_a_file(write_scans, tmp_path, capsys):
    scans = sorted(write_scans().iterdir())
    assert main([str(word) for word in (*scans, "-o", f"{tmp_path}/")]) == 2
    assert "the name of a clip ends in .gclip" in capsys.readouterr().err


def test_a_cache_that_links_to_itself_is_said(write_scans, tmp_path, capsys):
    loop = tmp_path / "loop"
    loop.symlink_to(loop)
    words = [write_scans(), "-o", tmp_path / "p.gclip", "--cache", loop, "-q"]
    assert main([str(word) for word in words]) == 2
    assert capsys.readouterr().err == f"bake: {loop} can't be written: File exists.\n"
