"""Long bakes go on where they were stopped, and leave nothing beside the clip in the end."""

from __future__ import annotations

from pathlib import Path

import pytest

from baker.batch.command import MIN_BYTES_TO_CACHE
from baker.cli import main
from gclip import Clip


@pytest.fixture
def command(write_scans, tmp_path) -> list[str]:
    scans = write_scans(days=(0, 1, 2))
    return [
        str(scans),
        "-o",
        str(tmp_path / "plant.gclip"),
        "--align",
        "none",
        "--up",
        "z",
        "--force",
    ]


def test_a_long_bake_that_was_stopped_goes_on(command, tmp_path, monkeypatch, capsys):
    assert main(command) == 0
    clean = (tmp_path / "plant.gclip").read_bytes()
    with Path(command[0], "notes.bin").open("wb") as file:
        file.truncate(MIN_BYTES_TO_CACHE)  # no scan, but the folder is as large as a long bake's
    with monkeypatch.context() as stopped:
        stopped.setattr(Clip, "save", _stop)
        assert main(command) == 130
    begun = tmp_path / ".plant.gclip.begun"
    assert len(list(begun.glob("*/*"))) == 2  # intervals
    assert (tmp_path / "plant.gclip").read_bytes() == clean
    assert main(command) == 0
    assert "2 of 2 intervals" in capsys.readouterr().err
    assert (tmp_path / "plant.gclip").read_bytes() == clean
    assert not begun.exists()


def test_a_small_bake_keeps_nothing(command, tmp_path, monkeypatch):
    before = {path.name for path in tmp_path.iterdir()}
    with monkeypatch.context() as stopped:
        stopped.setattr(Clip, "save", _stop)
        assert main(command) == 130
    assert {path.name for path in tmp_path.iterdir()} == before


SAVE = Clip.save


def _stop(clip: Clip, path: Path, force: bool = True) -> None:
    """Instead of `Clip.save`: all is done but the clip itself."""
    if path.name == "plant.gclip":
        raise KeyboardInterrupt
    SAVE(clip, path, force)
