"""Whether outputs can be written is known before the work."""

import os

import pytest

from baker.batch.outputs import check_output
from baker.errors import InputError


@pytest.mark.parametrize("name", ["a.txt", "folder.gclip", "missing/a.gclip"])
def test_names_that_cannot_be_written_are_refused(tmp_path, name):
    (tmp_path / "folder.gclip").mkdir()
    with pytest.raises(InputError, match=name):
        check_output(tmp_path / name, "a clip", ".gclip")


def test_a_folder_that_nothing_may_be_written_into_is_refused(tmp_path, monkeypatch):
    check_output(tmp_path / "a.gclip", "a clip", ".gclip")
    monkeypatch.setattr(os, "access", lambda path, mode: mode != os.W_OK)  # as for another user
    with pytest.raises(
        InputError, match=f"{tmp_path}: permission denied to write into this folder"
    ):
        check_output(tmp_path / "a.gclip", "a clip", ".gclip")
