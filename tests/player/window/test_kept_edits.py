"""Names given in the window are the clip's at once; what can't be is told, and not written."""

from __future__ import annotations

from pathlib import Path

import pytest

import gclip
from gclip.corrections import Correction, corrections_file, read_corrections, write_corrections
from player.ui import actions, keys
from player.view.camera import Camera
from player.view.organ_place import organ_place
from player.view.playback import Timeline
from player.view.state import Scene
from player.view.style import Style
from player.window.opened_clip import KeptEdits, OpenClip
from tests.player.shown import small_clip


@pytest.fixture
def opened(tmp_path: Path) -> OpenClip:
    small_clip().save(tmp_path / "plant.gclip")
    return OpenClip.of(tmp_path / "plant.gclip")


def called(kept: KeptEdits, scene: Scene, track: int, name: str) -> Scene:
    if scene.style.picked != track:
        place = organ_place(scene.clip, track, scene.timeline.day)
        scene = actions.pick(scene, track, place)
    return kept.written(actions.correct(scene, "name", name))


def names(scene: Scene) -> list[str]:
    return [track.name for track in scene.clip.track_table]


def test_names_are_seen_written_and_taken_back(opened: OpenClip) -> None:
    assert opened.file is not None
    clip, file = opened.clip, corrections_file(opened.file)
    stem, leaf = (track.name for track in clip.track_table[:2])
    scene = Scene(Timeline.of(clip.times).at(clip.times[-1]), Camera(), Camera(), Style(), (clip,))
    kept = KeptEdits(opened)
    scene = called(kept, kept.written(scene), 1, "flag")
    assert names(scene)[:2] == [stem, "flag"]
    assert "bake again" not in scene.notice
    assert [track.name for track in gclip.open(opened.file).track_table] == names(scene)
    scene = called(kept, scene, 1, "tip")
    assert names(scene)[:2] == [stem, "tip"]
    scene = called(kept, scene, 0, "tip")
    assert "Two organs are called 'tip'" in scene.notice
    assert names(scene)[:2] == [stem, "tip"]
    assert [one.name for one in read_corrections(file)] == ["flag", "tip"]
    for expected in ("flag", leaf):
        scene = kept.written(keys.pressed(scene, "ctrl+z"))
        assert names(scene)[:2] == [stem, expected]
    assert read_corrections(file) == ()


def test_a_file_that_names_two_organs_alike_is_told(opened: OpenClip) -> None:
    assert opened.file is not None
    clip = opened.clip
    scene = Scene(Timeline.of(clip.times), Camera(), Camera(), Style(), (clip,))
    places = [organ_place(clip, track, clip.times[-1]) for track in (0, 1)]
    alike = [Correction("name", (place,), "x") for place in places if place is not None]
    write_corrections(corrections_file(opened.file), alike)
    kept = KeptEdits(opened)
    scene = kept.written(scene)
    assert "Two organs are called 'x'" in scene.notice
    assert scene.clip.track_table == clip.track_table
    assert len(read_corrections(corrections_file(opened.file))) == len(alike) == 2
