"""An export that is killed, stopped or finds no room: what was there stays, and nothing else."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

SMALL = ["--size", "64x48", "-q", "--force"]
SMALL_FILM = [*SMALL, "--fps", "10", "--seconds"]
LIMITED = """
import resource, sys
sys.dont_write_bytecode = True  # what Python keeps of modules would be cut short for good
from player.cli import main
import player.export, PIL.Image, imageio_ffmpeg
resource.setrlimit(resource.RLIMIT_FSIZE, (600, 600))
clip = sys.argv[1]
for output in sys.stdin.read().split():
    size = ["--size", "64x48"] if output.endswith(("png", "mp4", "gif", "webm", "html")) else []
    film = ["--seconds", "1", "--fps", "10"] if "%" in output or "mp4" in output else []
    print(main([clip, "--export", output, "-q", "--force", *size, *film]))
"""

STOPPED_WHILE_COMPILING = """
import signal, sys, _moderngl
from player.cli import main
make = _moderngl.make_uniform
def make_and_stop(*arguments):
    signal.raise_signal(signal.SIGINT)
    return make(*arguments)
_moderngl.make_uniform = make_and_stop
signal.signal(signal.SIGINT, signal.default_int_handler)
sys.exit(main())
"""


@pytest.fixture
def clip(make_clip: Any, tmp_path: Path) -> Path:
    path = tmp_path / "plant.gclip"
    make_clip().save(path)
    return path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder that holds older outputs."""
    folder = tmp_path / "out"
    (folder / "frames").mkdir(parents=True)
    for name in ("film.mp4", "page.html", "plant.glb", "frames/0000.png"):
        (folder / name).write_text("old")
    return folder


def intact(folder: Path) -> bool:
    files = {str(p.relative_to(folder)): p for p in folder.rglob("*") if p.is_file()}
    names = {"film.mp4", "page.html", "plant.glb", "frames/0000.png"}
    drafts = list(folder.rglob(".*"))
    return set(files) == names and not drafts and {p.read_text() for p in files.values()} == {"old"}


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_stopped_export_says_so_and_leaves_nothing(
    clip: Path, folder: Path, number: signal.Signals
) -> None:
    command = [sys.executable, "-m", "player", str(clip), "--export", str(folder / "film.mp4")]
    process = subprocess.Popen([*command, *SMALL_FILM, "600"], stderr=subprocess.PIPE, text=True)
    while not any(path.name.startswith(".film") for path in folder.iterdir()):
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(number)
    said = process.communicate(timeout=120)[1]
    assert process.returncode == 128 + number
    assert said == "play: stopped; nothing half-written is left behind.\n"
    assert intact(folder)


def test_an_export_stopped_while_shaders_are_compiled_leaves_nothing(
    clip: Path, folder: Path
) -> None:
    """OpenGL's native code makes a Python object of each uniform, and crashes if that fails."""
    export = [str(clip), "--export", str(folder / "frames/%04d.png"), *SMALL_FILM, "600"]
    command = [sys.executable, "-c", STOPPED_WHILE_COMPILING, *export]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 130, done.stderr
    assert intact(folder)


def test_a_full_disk_is_one_sentence(clip: Path, folder: Path) -> None:
    """The process may write files of 600 bytes only: to it, the disk is full."""
    names = "film.mp4", "page.html", "plant.glb", "plant.usdc", "plant.usdz", "frames/%04d.png"
    outputs = "\n".join(str(folder / name) for name in names)
    command = [sys.executable, "-c", LIMITED, str(clip)]
    done = subprocess.run(command, input=outputs, capture_output=True, text=True, timeout=120)
    assert done.stdout.split() == ["2"] * len(names), done.stderr
    for sentence, name in zip(done.stderr.splitlines(), names, strict=True):
        assert sentence.startswith("play: ")
        assert name.partition("%")[0] in sentence
        assert "File too large" in sentence
    assert intact(folder)


def test_a_sequence_spares_what_else_is_in_its_folder(clip: Path, folder: Path) -> None:
    from player.cli import main

    (folder / "frames" / "notes.txt").write_text("mine")
    arguments = [str(clip), "--export", str(folder / "frames/%04d.png"), *SMALL_FILM, "0.5"]
    assert main(arguments) == 0
    names = {path.name for path in (folder / "frames").iterdir()}
    assert names == {"notes.txt", *(f"{number:04d}.png" for number in range(len(names) - 1))}
    assert len(names) > 4
    assert (folder / "frames" / "notes.txt").read_text() == "mine"
    assert (folder / "frames" / "0000.png").read_bytes()[:4] == b"\x89PNG"


@pytest.mark.parametrize("place", ["stood in", "with folders", "linked to"])
def test_a_sequence_goes_into_folders_of_every_kind(
    clip: Path, folder: Path, monkeypatch: pytest.MonkeyPatch, place: str
) -> None:
    from player.cli import main

    frames = folder / "frames"
    if place == "stood in":
        monkeypatch.chdir(frames)
        frames = Path()
    elif place == "with folders":
        (frames / "more").mkdir()
    else:
        shutil.move(frames, folder / "elsewhere")
        frames.symlink_to("elsewhere")
    arguments = [str(clip), "--export", str(frames / "%04d.png"), *SMALL_FILM, "0.5"]
    assert main(arguments) == 0
    assert (folder / "frames").is_symlink() == (place == "linked to")
    assert (frames / "0000.png").read_bytes()[:4] == b"\x89PNG"
    assert not list(folder.rglob(".*"))


def test_a_sequence_into_a_file_is_refused(clip: Path, folder: Path, capsys: Any) -> None:
    from player.cli import main

    assert main([str(clip), "--export", str(folder / "film.mp4" / "%04d.png"), *SMALL]) == 2
    assert "can't be written: Not a directory" in capsys.readouterr().err
    assert intact(folder)


def test_exports_write_nothing_elsewhere(clip: Path, tmp_path: Path) -> None:
    """But what graphics drivers and compilers keep (docs/cache.md)."""
    places = {name: tmp_path / name for name in ("home", "temporary", "here", "made")}
    for place in places.values():
        place.mkdir()
    inherited = {key: value for key, value in os.environ.items() if not key.startswith("XDG_")}
    environment = {
        **inherited,
        "HOME": str(places["home"]),
        "TMPDIR": str(places["temporary"]),
        "PYTHONPATH": str(Path(__file__).parents[2]),
    }
    for output in ("film.mp4", "page.html"):
        export = ["-m", "player", str(clip), "--export", str(places["made"] / output), *SMALL]
        export += ["--seconds", "1", "--fps", "10"] if output == "film.mp4" else []
        subprocess.run(
            [sys.executable, *export], cwd=places["here"], env=environment, check=True, timeout=120
        )
    assert {path.name for path in places["made"].iterdir()} == {"film.mp4", "page.html"}
    assert not [*places["temporary"].rglob("*"), *places["here"].rglob("*")]
    kept = {path.relative_to(places["home"]).parts[:2] for path in places["home"].rglob("*")}
    assert kept <= {(".cache",), (".cache", "numba"), *_shaders(kept)}


def _shaders(places: set[tuple[str, ...]]) -> set[tuple[str, ...]]:
    return {place for place in places if place[-1].startswith(("mesa", ".nv", "nvidia"))}
