"""What the window remembers, and that nothing can make it fail."""

from pathlib import Path

import pytest

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
