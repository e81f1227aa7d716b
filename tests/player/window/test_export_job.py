"""Exports beside a window: they end by themselves, when they are stopped, and with the window."""

import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from player.export.film import Film
from player.output_names import free_name
from player.window.export_job import Exports
from tests.player.conftest import ClipMaker
from tests.player.desk import scene_of
from tests.player.shown import small_clip

LONG = Film(size=(640, 480), seconds=600.0)


@pytest.fixture
def saved(make_clip: ClipMaker, tmp_path: Path) -> Path:
    make_clip().save(tmp_path / "plant.gclip")
    return tmp_path / "plant.gclip"


def begun_export(*job: Any) -> Exports:
    exports = Exports()
    exports.begin(*job)
    return exports


def ended(exports: Exports) -> str:
    scene = scene_of(small_clip())
    deadline = time.monotonic() + 120.0
    while not (scene := exports.followed(scene)).notice:
        assert time.monotonic() < deadline
        time.sleep(0.05)
    return scene.notice


def begun(folder: Path) -> None:
    deadline = time.monotonic() + 120.0
    while not list(folder.glob(".out.*/out.mp4")) and not list(folder.glob(".*mp4*/*")):
        assert time.monotonic() < deadline
        time.sleep(0.05)


def test_it_ends_with_a_file(saved: Path) -> None:
    export = begun_export(saved, Film(size=(64, 48), at=(1.0,)), saved.parent / "still.png")
    assert "Saved" in ended(export)
    assert (saved.parent / "still.png").is_file()


def test_what_fails_says_so_in_one_sentence(saved: Path) -> None:
    export = begun_export(saved.parent / "none.gclip", Film(), saved.parent / "a.png")
    assert "none.gclip" in ended(export)


def test_a_stopped_one_leaves_nothing(saved: Path) -> None:
    export = begun_export(saved, LONG, saved.parent / "out.mp4")
    begun(saved.parent)
    export.stop()
    assert "Stopped" in ended(export)
    assert [path.name for path in saved.parent.iterdir()] == ["plant.gclip"]


def test_one_whose_window_was_killed_leaves_nothing_either(saved: Path) -> None:
    code = f"""
import sys, time
from pathlib import Path
from player.export.film import Film
from player.output_names import free_name
from player.window.export_job import Exports
if __name__ == "__main__":
    folder = Path({str(saved.parent)!r})
    film = Film(size=(640, 480), seconds=600.0)
    exports = Exports()
    exports.begin(folder / "plant.gclip", film, folder / "out.mp4")
    time.sleep(600)
"""
    window = subprocess.Popen([sys.executable, "-c", code])
    begun(saved.parent)
    window.kill()
    window.wait()
    deadline = time.monotonic() + 120.0
    while [path.name for path in saved.parent.iterdir()] != ["plant.gclip"]:
        assert time.monotonic() < deadline
        time.sleep(0.1)


def test_names_are_free_and_plain(tmp_path: Path) -> None:
    assert free_name("a plant/x", "film.mp4", tmp_path).name == "a-plant-x.mp4"
    (tmp_path / "p.mp4").touch()
    assert free_name("p", "film.mp4", tmp_path).name == "p-2.mp4"
    assert free_name("p", "frames/%04d.png", tmp_path) == tmp_path / "p-frames" / "%04d.png"
    (tmp_path / "p-frames").mkdir()
    assert free_name("p", "frames/%04d.png", tmp_path).parent.name == "p-2-frames"
    assert free_name("...", "plant.html", tmp_path).name == "plant.html"
