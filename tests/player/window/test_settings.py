"""What the window remembers, and that nothing can make it fail."""

from pathlib import Path
from typing import Any

import pytest

from player.view.camera import Camera
from player.view.playback import Timeline
from player.view.state import Scene
from player.view.style import Style
from player.window.launch import start
from player.window.settings import FILE, Settings, load_settings, save_settings


@pytest.fixture
def folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    monkeypatch.setattr("player.window.settings._folder", lambda: tmp_path / "deep" / "config")
    return tmp_path / "deep" / "config"


def test_what_was_saved_comes_back(folder: Path) -> None:
    assert load_settings() == Settings()
    kept = Settings((900, 700), False, "light", True, False)
    save_settings(kept)
    assert load_settings() == kept
    assert [file.name for file in folder.iterdir()] == [FILE]


@pytest.mark.parametrize(
    "text",
    ["", "[]", "nonsense", '{"size": [1, 2]}', '{"size": "big", "panel": 3, "ground": "pink"}',
     '{"size": [900, true, 3], "later": {}}', "[" * 100_000],
)  # fmt: skip
def test_nonsense_is_no_setting(folder: Path, text: str) -> None:
    folder.mkdir(parents=True)
    (folder / FILE).write_text(text)
    assert load_settings() == Settings()


def test_a_folder_that_cannot_be_written_is_no_trouble(folder: Path) -> None:
    folder.parent.mkdir(parents=True)
    folder.write_text("a file stands in the way")
    save_settings(Settings(panel=True))
    assert load_settings() == Settings()


def test_the_platform_s_own_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    import sys

    if not sys.platform.startswith("linux"):
        pytest.skip("XDG's folders are Linux's")
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    save_settings(Settings(panel=True))
    assert (tmp_path / "plant-growth-clips" / FILE).is_file()


@pytest.mark.parametrize(("width", "opened"), [(1280, True), (480, False)])
def test_a_narrow_window_begins_without_the_panel_and_a_wide_one_still_has_it(
    folder: Path, clip_file: Path, monkeypatch: pytest.MonkeyPatch, width: int, opened: bool
) -> None:
    seen: list[bool] = []

    def shown(
        clips: object, style: Style, size: tuple[int, int], changes: Any, **rest: Any
    ) -> tuple:
        timeline = Timeline.of((0.0, 1.0))
        camera = Camera()
        scene = Scene(timeline, camera, camera, style, (), **changes)
        seen.append(scene.panel)
        return scene, size

    monkeypatch.setattr("player.window.launch.show", shown)
    start([clip_file], Style(), size=(width, 700))
    assert seen == [opened]
    assert load_settings().panel is not False
