"""Exports beside a window: they end by themselves, when they are stopped, and with the window."""

import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from player.export.film import Film
from player.output_names import unused_path
from player.view.annotations import Annotations
from player.view.camera_animation import load_path
from player.view.choices import Request
from player.view.state import ExportProgress
from player.window.export_job import ExportJob, film_of
from player.window.opened_clip import OpenClip
from tests.player.conftest import ClipMaker
from tests.player.desk import scene_of
from tests.player.shown import small_clip

LONG = Film(size=(640, 480), seconds=600.0)


@pytest.fixture
def saved(make_clip: ClipMaker, tmp_path: Path) -> Path:
    make_clip().save(tmp_path / "plant.gclip")
    return tmp_path / "plant.gclip"


def begun_export(*job: Any) -> ExportJob:
    exports = ExportJob()
    exports.begin(*job)
    return exports


def ended(exports: ExportJob) -> str:
    scene = scene_of(small_clip())
    deadline = time.monotonic() + 120.0
    while not (scene := exports.with_progress(scene)).notice:
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


def test_a_picture_waits_for_the_export_under_way(saved: Path) -> None:
    exports, scene = ExportJob(), scene_of(small_clip())
    exports.state = ExportProgress("film.mp4", 1, 2)
    asked = replace(scene, request=Request.PICTURE)
    told = exports.handle_request(asked, OpenClip.from_file(saved), (640, 480))
    assert told == replace(scene, notice="film.mp4 is being exported; E stops it.")


def test_exports_have_the_annotations_of_the_window(make_clip: ClipMaker) -> None:
    scene = replace(scene_of(make_clip()), guides=True, legend=True)
    shown = film_of(scene, "still.png", (640, 480), "plant").annotations
    assert shown == Annotations(scale_bar=True, legend=True)
    bare = replace(scene, guides=False, legend=False)
    assert film_of(bare, "still.png", (640, 480), "plant").annotations == Annotations()
    scans = scene_of(make_clip(colors=((9, 9, 9, 255),) * 2))  # colours that have no legend
    shown = film_of(replace(scans, legend=True), "still.png", (640, 480), "plant").annotations
    assert shown == Annotations(scale_bar=True)


def test_a_camera_key_is_added_to_those_in_the_file_beside_the_clip(
    saved: Path, monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> None:
    monkeypatch.chdir(tmp_path_factory.mktemp("elsewhere"))
    folder = saved.parent
    opened = OpenClip.from_file(folder / ".." / folder.name / saved.name)
    scene = scene_of(opened.clip)
    for day in (0.0, 5.0, 5.0):  # each time as if the window had just opened
        asked = replace(scene, request=Request.CAMERA_KEY, timeline=scene.timeline.at(day))
        told = ExportJob().handle_request(asked, opened, (640, 480))
    kept = load_path(folder / "plant.camera.json", opened.clip)
    for path in (told.path, kept):
        assert [day for day, _ in path.keys] == [0.0, 5.0]
    assert told.notice == f"Saved plant.camera.json in {folder}, 2 keys"
    assert not list(Path().iterdir())


def test_one_whose_window_was_killed_leaves_nothing_either(saved: Path) -> None:
    code = f"""
import sys, time
from pathlib import Path
from player.export.film import Film
from player.output_names import unused_path
from player.window.export_job import ExportJob
if __name__ == "__main__":
    folder = Path({str(saved.parent)!r})
    film = Film(size=(640, 480), seconds=600.0)
    exports = ExportJob()
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
    assert unused_path("a plant/x", "film.mp4", tmp_path).name == "a-plant-x.mp4"
    (tmp_path / "p.mp4").touch()
    assert unused_path("p", "film.mp4", tmp_path).name == "p-2.mp4"
    assert unused_path("p", "frames/%04d.png", tmp_path) == tmp_path / "p-frames" / "%04d.png"
    (tmp_path / "p-frames").mkdir()
    assert unused_path("p", "frames/%04d.png", tmp_path).parent.name == "p-2-frames"
    assert unused_path("...", "plant.html", tmp_path).name == "plant.html"
