"""The examples in README.md and docs/ are run: the commands, the Python, the files they show.

A block that can't be run says why in a comment just above it: `<!-- not run: why -->`. Pictures are
smaller and plants have fewer points than in print; lines that open a window are run under Xvfb.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from baker.cli import main as bake
from grow.cli import main as grow
from player.cli import main as play

ROOT = Path(__file__).parents[2]
PAGES = (
    "README.md",
    "docs/howto/scans.md",
    "docs/howto/wrong.md",
    "docs/howto/film.md",
    "docs/howto/traits.md",
    "docs/howto/many.md",
    "docs/cache.md",
    "docs/player.md",
    "docs/exports.md",
    "docs/images.md",
    "docs/format.md",
    "docs/api.md",
    "docs/corrections.md",
)
BLOCK = re.compile(r"(?:<!-- not run: (.+?) -->\n)?^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
SMALL_PLANT = ["--points", "700", "--scans", "4"]
SMALL_IMAGES = ["--size", "96x72", "--days", "2"]
SMALL_PICTURE, SMALL_RATE = ["--size", "96x64"], ["--fps", "2"]  # the latter of films
PICTURES = (".mp4", ".gif", ".webm", ".png")


@dataclass(frozen=True)
class Block:
    page: str
    number: int
    language: str
    text: str
    not_run: str

    def __str__(self) -> str:
        return f"{self.page}:{self.number}"


def blocks_of(page: str) -> list[Block]:
    found = BLOCK.findall((ROOT / page).read_text("utf-8"))
    return [Block(page, n, lang, text, why) for n, (why, lang, text) in enumerate(found, 1)]


@pytest.fixture(scope="module")
def plant(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a grown plant's scans and clip, and what else the pages take for granted."""
    folder = tmp_path_factory.mktemp("plant")
    assert grow(["maize", str(folder / "scans"), *SMALL_PLANT, "-q"]) == 0
    clip, images = folder / "plant.gclip", folder / "komatsuna"
    straight = ["--up", "z", "--paths", "straight", "-q"]
    assert bake([str(folder / "scans"), "-o", str(clip), *straight]) == 0
    days = {path.name: path.stem.removeprefix("day") for path in (folder / "scans").iterdir()}
    lines = (f"{name} {day}" for name, day in days.items())
    (folder / "days.txt").write_text("\n".join(lines), "utf-8")
    for name in ("maize_07", "maize_08"):
        shutil.copytree(folder / "scans", folder / "greenhouse" / name)
    for name in ("monday", "tuesday"):
        (folder / f"{name}.gclip").write_bytes(clip.read_bytes())
    assert grow(["komatsuna", str(images), *SMALL_IMAGES, "-q"]) == 0
    (path,) = (block for block in blocks_of("docs/player.md") if block.language == "json")
    (folder / "plant.camera.json").write_text(path.text, "utf-8")
    return folder


@pytest.mark.parametrize("page", PAGES)
def test_examples_run(
    page: str,
    plant: Path,
    display: dict[str, str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    shutil.copytree(plant, tmp_path / "own")  # pages write files of the same names
    monkeypatch.chdir(tmp_path / "own")
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "settings"))
    blocks = [block for block in blocks_of(page) if not block.not_run]
    assert blocks or page == "docs/exports.md"
    clear_outputs("".join(block.text for block in blocks), Path())
    names: dict[str, object] = {"__name__": "example"}  # a page's examples build on each other
    for block in blocks:
        if block.language == "python":
            exec(compile(block.text, str(block), "exec"), names)
        else:
            RUNNERS[block.language](block.text, display)


def clear_outputs(text: str, folder: Path) -> None:
    """Take away what a page writes before it reads it: its commands overwrite nothing unforced."""
    made = r"(?:^grow \w+|-o|--traits|--report|--export) (\S+)"
    for output in re.finditer(made, text, re.MULTILINE):
        if not re.search(rf"(?<![\w/]){re.escape(output[1])}", text[: output.start(1)]):
            path = folder / output[1]
            shutil.rmtree(path) if path.is_dir() else path.unlink(missing_ok=True)


def run_shell(text: str, display: dict[str, str]) -> None:
    for line in text.splitlines():
        program, *words = shlex.split(line, comments=True)
        if program == "grow":
            assert grow([*words, *SMALL_PLANT]) == 0, line
        elif program == "bake":
            assert bake([*words, "--paths", "straight", "--workers", "1"]) == 0, line
        elif "--export" in words:
            drawn = words[words.index("--export") + 1].endswith(PICTURES)
            rate = [] if "--day" in words else SMALL_RATE
            assert play([*words, *([*SMALL_PICTURE, *rate] if drawn else [])]) == 0, line
        elif {"--info", "--list-exports"} & set(words):
            assert play(words) == 0, line
        else:
            in_window(words, display)


def in_window(words: list[str], display: dict[str, str]) -> None:
    """The window opens, and Q closes it."""
    player = subprocess.Popen(
        [sys.executable, "-m", "player", *words, "--size", "480x320"],
        env={**os.environ, **display}, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        deadline = time.monotonic() + 120.0
        while player.poll() is None and time.monotonic() < deadline:
            subprocess.run(["xdotool", "key", "q"], env={**os.environ, **display}, check=False)
            time.sleep(0.2)
        assert player.poll() == 0, f"{words}: {player.stderr and player.stderr.read()}"
    finally:
        player.kill()
        player.wait()


RUNNERS: dict[str, Callable[[str, dict[str, str]], object]] = {
    "sh": run_shell,
    "json": lambda text, display: json.loads(text),
    "toml": lambda text, display: tomllib.loads(text),
}


def test_options_that_pages_name_exist(capsys: pytest.CaptureFixture[str]) -> None:
    for program in (bake, play, grow):
        assert program(["--help"]) == 0
    known = options(capsys.readouterr().out)
    for page in PAGES:
        text = re.sub("`python -m .*?`", "", (ROOT / page).read_text("utf-8"))
        unknown = options(" ".join(re.findall(r"`[^`\n]*`", text))) - known
        assert not unknown, page


def options(text: str) -> set[str]:
    return set(re.findall(r"(?<![\w-])--[a-z][a-z-]*[a-z]", text))
