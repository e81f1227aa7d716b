"""Exports hold what they should, and appear whole or not at all."""

from __future__ import annotations

import json
import stat
from pathlib import Path

import imageio.v3 as iio
import imageio_ffmpeg
import numpy as np
import pytest

from gclip import Clip
from gclip.errors import UserError
from player import render
from player.errors import PlayerError
from player.export import Film, export
from player.rendering.headless import Offscreen

SMALL = Film(size=(64, 48), fps=10, seconds=0.6)


@pytest.fixture
def clip(make_clip) -> Clip:
    return make_clip()


def only(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_render_gives_a_picture(clip: Clip) -> None:
    picture = render(clip, 1.0, size=(64, 48))
    assert picture.shape == (48, 64, 4)
    assert picture.dtype == np.uint8
    assert (picture[..., 3] == 255).all()
    assert (picture == render(clip, 1.0, size=(64, 48))).all()


def test_mp4_has_the_frames_size_and_color_tags(clip: Clip, tmp_path: Path) -> None:
    export(clip, SMALL, tmp_path / "film.mp4")
    assert only(tmp_path) == ["film.mp4"]
    reader = imageio_ffmpeg.read_frames(str(tmp_path / "film.mp4"))
    about = next(reader)
    assert about["size"] == (64, 48)
    assert about["fps"] == 10
    assert about["codec"] == "h264"
    assert about["pix_fmt"] == "yuv420p(tv, bt709, progressive)"
    assert len(list(reader)) == 6


def test_mp4_shows_the_colors_that_were_drawn(make_clip, tmp_path: Path) -> None:
    red = (200, 40, 30, 255)
    clip, path = make_clip(colors=(red, red)), tmp_path / "film.mp4"
    drawn = render(clip, clip.times[-1], size=(64, 48))[..., :3].astype(int)
    export(clip, SMALL, path)
    reader = imageio_ffmpeg.read_frames(
        str(path), output_params=["-vf", "scale=in_color_matrix=bt709:in_range=tv"]
    )
    next(reader)
    shown = np.frombuffer(list(reader)[-1], np.uint8).reshape(48, 64, 3).astype(int)
    assert np.abs(shown.mean(axis=(0, 1)) - drawn.mean(axis=(0, 1))).max() < 1.5


def test_the_same_film_has_the_same_bytes(clip: Clip, tmp_path: Path) -> None:
    for name in ("a.mp4", "b.mp4", "a.gif", "b.gif"):
        export(clip, SMALL, tmp_path / name)
    for suffix in ("mp4", "gif"):
        first, second = ((tmp_path / f"{n}.{suffix}").read_bytes() for n in "ab")
        assert first == second


def test_mov_holds_the_film_of_mp4(clip: Clip, tmp_path: Path) -> None:
    frames = []
    for suffix, brand in (("mov", b"qt  "), ("mp4", b"isom")):
        path = tmp_path / f"film.{suffix}"
        export(clip, SMALL, path)
        assert path.read_bytes()[8:12] == brand
        frames.append(list(imageio_ffmpeg.read_frames(str(path)))[1:])
    assert frames[0] == frames[1]


def test_gif_loops_and_holds_the_frames(clip: Clip, tmp_path: Path) -> None:
    from PIL import Image

    export(clip, SMALL, tmp_path / "film.gif")
    assert only(tmp_path) == ["film.gif"]
    with Image.open(tmp_path / "film.gif") as film:
        assert film.size == (64, 48)
        assert film.info["loop"] == 0
        # Frames at rest may be merged into one longer one: the time they take counts.
        durations = []
        for index in range(film.n_frames):
            film.seek(index)
            durations.append(film.info["duration"])
        assert sum(durations) == pytest.approx(600, abs=110)
        film.seek(film.n_frames - 1)
        last = np.asarray(film.convert("RGB")).astype(int)
    drawn = render(clip, clip.times[-1], size=(64, 48))[..., :3].astype(int)
    assert np.abs(last - drawn).mean() < 6


def test_png_sequence_and_still(clip: Clip, tmp_path: Path) -> None:
    export(clip, SMALL, tmp_path / "f%03d.png")
    assert only(tmp_path) == [f"f{i:03d}.png" for i in range(6)]
    day = Film(size=(64, 48), at=(1.0,))
    export(clip, day, tmp_path / "still.png")
    still = iio.imread(tmp_path / "still.png")
    assert (still == render(clip, 1.0, size=(64, 48))[..., :3]).all()


@pytest.mark.parametrize("suffix", ["jpg", "JPEG"])
def test_jpeg_sequence_and_still(clip: Clip, tmp_path: Path, suffix: str) -> None:
    export(clip, SMALL, tmp_path / f"f%03d.{suffix}")
    assert only(tmp_path) == [f"f{i:03d}.{suffix}" for i in range(6)]
    export(clip, Film(size=(64, 48), at=(1.0,)), tmp_path / f"still.{suffix}")
    content = (tmp_path / f"still.{suffix}").read_bytes()
    assert content.startswith(b"\xff\xd8\xff")
    still = iio.imread(content).astype(int)
    drawn = render(clip, 1.0, size=(64, 48))[..., :3].astype(int)
    assert np.abs(still - drawn).mean() < 3
    with pytest.raises(PlayerError, match="--transparent is for PNG pictures"):
        export(clip, Film(size=(64, 48), transparent=True), tmp_path / f"clear.{suffix}")


def test_pictures_of_chosen_days_carry_their_view(clip: Clip, tmp_path: Path) -> None:
    from PIL import Image

    export(clip, Film(size=(64, 48), at=(4.0, 1.0)), tmp_path / "f%d.png")
    assert only(tmp_path) == ["f0.png", "f1.png"]
    second = Image.open(tmp_path / "f1.png")
    assert (np.asarray(second) == render(clip, 1.0, size=(64, 48))[..., :3]).all()
    view = np.array(json.loads(second.info["view"]))
    seen = np.column_stack([clip.at(1.0).local, np.ones(len(clip.at(1.0)))]) @ view.T
    assert (np.abs(seen[:, :2]) < seen[:, 3:]).all(), "the whole plant is in the picture"


def test_the_turntable_turns_and_the_still_camera_does_not(make_clip) -> None:
    clip = make_clip()
    film = Film(size=(64, 48), fps=4, seconds=1.0, turning=True)
    assert film.cameras(clip)[0].distance >= Film(size=(64, 48)).cameras(clip)[0].distance


def test_what_rests_is_drawn_once(clip: Clip, monkeypatch: pytest.MonkeyPatch) -> None:
    film = Film(size=(64, 48), fps=10, seconds=5.0)
    drawn: list[float] = []
    monkeypatch.setattr(
        Offscreen, "_picture", lambda self, day, *_: drawn.append(day) or np.full((48, 64, 4), day)
    )
    with Offscreen(clip, film.size) as offscreen:
        shown = [picture[0, 0, 0] for picture in film.frames(clip, offscreen)]
    assert shown == film.days(clip)
    assert drawn == sorted(set(shown))
    assert len(drawn) < len(shown) - 5


def test_a_film_runs_in_real_time_from_the_first_scan_to_the_last(clip: Clip) -> None:
    days = Film(fps=30, seconds=4.0).days(clip)
    assert len(days) == 120
    assert days[0] == 0.0
    assert days[-1] == 5.0
    steps = np.diff(days)
    assert (steps >= 0).all()
    assert steps.max() < 1.3 * 5.0 / 120


@pytest.mark.parametrize(
    ("name", "film", "words"),
    [
        ("film.avi", SMALL, ".mp4, .mov, .gif"),
        ("film", SMALL, ".mp4, .mov, .gif"),
        ("missing/film.mp4", SMALL, "No such file"),
        ("film.mp4", Film(size=(63, 48)), "64x48"),
        ("film.mp4", Film(at=(1.0,)), "it is for still.png"),
        ("still.png", Film(at=(1.0, 2.0)), "several"),
        ("film.gif", Film(fps=60), "50"),
        ("%s.png", SMALL, "%04d"),
        ("a%03d-%03d.png", SMALL, "%04d"),
    ],
)
def test_what_cannot_come_out_well_is_refused(
    clip: Clip, tmp_path: Path, name: str, film: Film, words: str
) -> None:
    with pytest.raises(UserError, match=words):
        export(clip, film, tmp_path / name)
    assert only(tmp_path) == []


@pytest.mark.parametrize("command", ["exit 1", "head -c 20000 >/dev/null", "cat >/dev/null"])
def test_an_encoder_that_fails_leaves_nothing(
    clip: Clip, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    broken = tmp_path / "ffmpeg"
    broken.write_text(f"#!/bin/sh\n{command}\n")
    broken.chmod(broken.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(broken))
    (tmp_path / "film.mp4").write_text("an earlier film")
    with pytest.raises(PlayerError, match=r"film\.mp4 can't be written: .*ffmpeg gave up"):
        export(clip, SMALL, tmp_path / "film.mp4")
    assert only(tmp_path) == ["ffmpeg", "film.mp4"]
    assert (tmp_path / "film.mp4").read_text() == "an earlier film"


def test_no_encoder_at_all_is_a_sentence(
    clip: Clip, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(tmp_path / "none"))
    with pytest.raises(PlayerError, match="no ffmpeg was found"):
        export(clip, SMALL, tmp_path / "film.mp4")
    assert only(tmp_path) == []


@pytest.mark.parametrize("suffix", ["webm", "gif"])
def test_odd_sides_are_kept(clip: Clip, tmp_path: Path, suffix: str) -> None:
    export(clip, Film(size=(65, 47), fps=10, seconds=0.6), tmp_path / f"film.{suffix}")
    reader = imageio_ffmpeg.read_frames(str(tmp_path / f"film.{suffix}"))
    assert next(reader)["size"] == (65, 47)
    assert len(list(reader)) == 6


def test_stopping_half_way_leaves_nothing(clip: Clip, tmp_path: Path) -> None:
    def stop(done: int, total: int) -> None:
        if done == 3:
            raise KeyboardInterrupt

    for name in ("film.mp4", "film.gif", "%04d.png"):
        with pytest.raises(KeyboardInterrupt):
            export(clip, SMALL, tmp_path / name, stop)
    assert only(tmp_path) == []


def test_a_sequence_makes_its_own_folder_and_takes_it_back(clip: Clip, tmp_path: Path) -> None:
    film = Film((32, 32), 5, 0.4)
    export(clip, film, tmp_path / "frames" / "%04d.png", lambda done, total: None)
    assert only(tmp_path / "frames")[0] == "0000.png"

    def stop(done: int, total: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        export(clip, film, tmp_path / "stopped" / "%04d.png", stop)
    assert only(tmp_path) == ["frames"]
    with pytest.raises(UserError, match="No such file"):
        export(clip, film, tmp_path / "no" / "where" / "%04d.png", stop)
