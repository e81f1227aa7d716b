"""Corrections made in the window are written beside the clip; what can't be is told."""

from __future__ import annotations

from pathlib import Path

import pytest

import gclip
from corrections import Correction, corrections_file, read_corrections, write_corrections
from player.ui import actions, keys
from player.view.camera import Camera
from player.view.organ_place import organ_place
from player.view.playback import Timeline
from player.view.state import Scene
from player.view.style import Style
from player.window.opened_clip import CorrectionsFile, OpenClip
from tests.player.shown import small_clip


@pytest.fixture
def opened(tmp_path: Path) -> OpenClip:
    small_clip().save(tmp_path / "plant.gclip")
    return OpenClip.from_file(tmp_path / "plant.gclip")


def called(kept: CorrectionsFile, scene: Scene, track: int, name: str) -> Scene:
    if scene.style.picked != track:
        place = organ_place(scene.clip, track, scene.timeline.day)
        scene = actions.pick(scene, track, place)
    return kept.synchronized(actions.correct(scene, "name", name))


def test_names_are_written_and_taken_back(opened: OpenClip) -> None:
    assert opened.file is not None
    clip, file = opened.clip, corrections_file(opened.file)
    scene = Scene(Timeline.of(clip.times).at(clip.times[-1]), Camera(), Camera(), Style(), (clip,))
    kept = CorrectionsFile(opened)
    scene = called(kept, kept.synchronized(scene), 1, "flag")
    assert scene.notice == "leaf is called flag: bake again to see it"
    assert scene.edits is not None
    assert not scene.edits.is_baked
    scene = called(kept, scene, 1, "tip")
    assert [one.name for one in read_corrections(file)] == ["flag", "tip"]
    assert scene.clip.track_table == gclip.open(opened.file).track_table == clip.track_table
    for expected in (["flag"], []):
        scene = kept.synchronized(keys.apply_key(scene, "ctrl+z"))
        assert [one.name for one in read_corrections(file)] == expected


def test_a_file_that_is_edited_is_taken_over_or_told(opened: OpenClip) -> None:
    assert opened.file is not None
    clip, file = opened.clip, corrections_file(opened.file)
    scene = Scene(Timeline.of(clip.times), Camera(), Camera(), Style(), (clip,))
    place = organ_place(clip, 1, clip.times[-1])
    assert place is not None
    write_corrections(file, [Correction("name", (place,), "x")])
    kept = CorrectionsFile(opened)
    scene = kept.synchronized(scene)
    assert scene.edits is not None
    assert [one.name for one in scene.edits.current] == ["x"]
    file.write_text("nonsense")
    scene = kept.synchronized(scene)
    assert "is not valid TOML" in scene.notice
    assert file.read_text() == "nonsense"
