"""The command `play`: every wrong wish gets one sentence and exit code 2."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import moderngl
import numpy as np
import pytest

import gclip
import player.export
from player.cli import main
from player.export import Film
from tests.player.conftest import ClipMaker


@pytest.fixture
def saved(make_clip, tmp_path: Path) -> Path:
    path = tmp_path / "plant.gclip"
    make_clip().save(path)
    return path


def refusal(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    assert main([str(argument) for argument in arguments]) == 2
    output, sentence = capsys.readouterr()
    assert output == ""
    assert sentence.startswith("play: ")
    assert sentence.count("\n") == 1
    assert "Traceback" not in sentence
    return sentence


def test_export_writes_and_tells(saved: Path, capsys: pytest.CaptureFixture[str]) -> None:
    film = saved.with_name("film.mp4")
    wish = [str(saved), "--export", str(film), "--size", "64x48", "--seconds", "0.3"]
    assert main([*wish, "--fps", "10", "--camera", "turntable", "--ground", "light"]) == 0
    assert film.stat().st_size > 500
    assert "film.mp4" in capsys.readouterr().err
    film.write_bytes(b"an earlier one")
    assert "film.mp4 exists; --force overwrites it." in refusal(capsys, *wish)
    assert film.read_bytes() == b"an earlier one"
    assert main([*wish, "-q", "--force"]) == 0
    assert capsys.readouterr() == ("", "")
    assert film.stat().st_size > 500


def test_a_sequence_overwrites_none_of_its_files(saved: Path, capsys) -> None:
    frames = saved.with_name("frames")
    wish = [saved, "--export", frames / "%04d.ply", "--seconds", "0.1"]
    assert main([*map(str, wish), "-q"]) == 0
    (frames / "0000.ply").unlink()
    assert "0001.ply exists; --force overwrites it." in refusal(capsys, *wish)
    assert main([*map(str, wish), "-q", "--force"]) == 0


def test_help_lists_options_by_what_they_are_about(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    said = capsys.readouterr().out
    places = [said.index(words) for words in ("play plant.gclip --export", " View ", " Window ")]
    assert places == sorted(places)
    assert said.index(" Export ") < said.index("--force") < said.index("Keys and mouse")
    assert "  Space   " in said


def test_info_tells_what_the_clip_holds(saved: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(saved), "--info"]) == 0
    text = capsys.readouterr().out
    for word in ("a.ply", "1,600", "day 5", "16 bit", "mm", "made by hand"):
        assert word in text
    assert "leaf [bold]x[/bold]" in text
    assert "{" not in text, "it is for people"


def test_bad_wishes(saved: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    notes = tmp_path / "notes.gclip"
    notes.write_text("not a clip at all")
    cut = tmp_path / "cut.gclip"
    cut.write_bytes(saved.read_bytes()[:-100])
    out = tmp_path / "out.png"
    assert "no such file" in refusal(capsys, tmp_path / "absent.gclip", "--info")
    assert "not a growth clip" in refusal(capsys, notes, "--export", out)
    assert "cut short" in refusal(capsys, cut, "--export", out)
    assert "No such file" in refusal(capsys, saved, "--export", tmp_path / "no" / "x.mp4")
    assert "1280x720" in refusal(capsys, saved, "--export", out, "--size", "big")
    assert "16" in refusal(capsys, saved, "--export", out, "--size", "0x100")
    for day in ("9", "nan", "-0.1", "Monday", "2024-05-01"):
        said = refusal(capsys, saved, "--export", out, "--day", day)
        assert f"--day is {day}; a time from 0 to 5" in said
    assert "--seconds" in refusal(capsys, saved, "--export", out, "--seconds", "nan")
    (tmp_path / "folder.png").mkdir()
    assert "is a folder" in refusal(capsys, saved, "--export", tmp_path / "folder.png")
    assert "--fps" in refusal(capsys, saved, "--export", out, "--fps", "0")
    assert "CLIP" in refusal(capsys)
    table = tmp_path / "t.csv"
    for words in (["--color", "age"], ["--ground", "light"], ["--camera", "turntable"]):
        said = refusal(capsys, saved, "--export", table, *words)
        assert f"{words[0]} has no effect on t.csv; it is for film.mp4" in said
    assert "has no suffix" in refusal(capsys, saved, "--export", tmp_path / "film")
    assert not out.exists()


@pytest.mark.parametrize(
    ("name", "words", "said"),
    [
        ("s.png", ["--every", "3"], "--every has no effect on s.png; it is for film.mp4, film.gif"),
        ("p.html", ["--every", "3"], "--every has no effect on p.html"),
        ("c.ply", ["--fps", "9"], "--fps has no effect on c.ply"),
        ("f.mp4", ["--day", "1"], "--day has no effect on f.mp4; it is for still.png"),
        ("p.glb", ["--no-floor"], "--floor has no effect on p.glb"),
        ("t.csv", ["--scale-bar"], "--scale-bar has no effect on t.csv"),
        ("p.html", ["--scale-bar"], "--scale-bar has no effect on p.html"),
        ("p.html", ["--color", "height"], "p.html takes auto, scan, track, growth, field, error."),
        ("c.ply", ["--color", "speed"], "--color speed changes while the plant grows"),
        ("%04d.mp4", [], "%04d.mp4 is numbered; only pictures and point clouds can be numbered."),
    ],
)
def test_options_without_effect_are_refused(
    saved: Path, capsys: pytest.CaptureFixture[str], name: str, words: list[str], said: str
) -> None:
    assert said in refusal(capsys, saved, "--export", saved.with_name(name), *words)
    assert not saved.with_name(name).exists()


@pytest.mark.parametrize("words", [["--title", "x"], ["--every", "2"], ["--force"], ["--date"]])
def test_the_window_refuses_options_of_exports(
    saved: Path, capsys: pytest.CaptureFixture[str], words: list[str]
) -> None:
    assert f"{words[0]} is for exports; add --export PATH." in refusal(capsys, saved, *words)


def test_one_picture_of_a_long_film_is_no_film(saved: Path) -> None:
    picture = saved.with_name("x.png")
    film = Film(size=(64, 64), seconds=36000, fps=240)
    player.export.export(gclip.open(saved), film, picture)
    assert picture.exists()


def test_no_egl_names_the_packages(
    saved: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise OSError("libEGL.so: cannot open shared object file")

    monkeypatch.setattr(moderngl, "create_context", fail)
    sentence = refusal(capsys, saved, "--export", saved.with_name("x.png"))
    assert "libegl1 libgl1" in sentence


def test_no_display_names_the_way_out(saved: Path) -> None:
    environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    done = subprocess.run(
        [sys.executable, "-m", "player", str(saved)],
        env=environment,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 2
    assert "--export" in done.stderr
    assert done.stderr.count("\n") == 1


def test_help_needs_no_graphics() -> None:
    probe = (
        "import sys; from player.cli import main; main(['--help']); "
        "heavy = {'moderngl', 'numpy', 'glfw', 'PIL', 'imageio'} & set(sys.modules); "
        "sys.exit(f'imported {heavy}' if heavy else 0)"
    )
    done = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "--export" in done.stdout


def test_a_camera_path_drives_the_export(make_clip: ClipMaker, tmp_path: Path) -> None:
    from PIL import Image

    from player.view.camera import Camera
    from player.view.camera_animation import CameraPath, save_path

    clip = make_clip()
    clip.save(tmp_path / "a.gclip")
    home = Camera.home(clip, 1.0)
    path = CameraPath().with_key(0.0, home).with_key(5.0, home.zoom(3.0))
    save_path(path, clip, tmp_path / "p.json")
    pictures = {}
    for day in ("0", "5"):
        output = tmp_path / f"{day}.png"
        arguments = [str(tmp_path / "a.gclip"), "--camera", str(tmp_path / "p.json")]
        assert (
            main([*arguments, "--export", str(output), "--day", day, "--size", "64x64", "-q"]) == 0
        )
        with Image.open(output) as picture:
            view = np.array(json.loads(picture.text["view"]))  # type: ignore[attr-defined]
        pictures[day] = view
    assert np.allclose(pictures["0"], home.matrix(1.0))
    assert np.allclose(pictures["5"], home.zoom(3.0).matrix(1.0))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--camera", "round"], "still, turntable or a camera path"),
        (["--camera", "none.json", "--export", "a.png"], "'none.json' can't be read"),
        (["b.gclip", "--info"], "the window shows one or two"),
    ],
)
def test_wrong_cameras_and_pairs_are_refused(
    make_clip: ClipMaker,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    message: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    make_clip().save(tmp_path / "a.gclip")
    assert main(["a.gclip", *arguments]) == 2
    assert message in " ".join(capsys.readouterr().err.split())


@pytest.mark.parametrize("name", ["2024-05-01.ply", "scan.las", "scans"])
def test_scans_are_to_be_baked_first(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, name: str
) -> None:
    path = tmp_path / name
    path.touch() if path.suffix else path.mkdir()
    said = refusal(capsys, path)
    assert "bake the scans first: bake " in said
    assert str(path if path.is_dir() else tmp_path) in said.partition("bake ")[2]
