"""Camera paths: through every key, smooth between, the same after a file."""

import json
import math
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gclip import Clip, UserError
from player.export.film import Film
from player.view.camera import Camera
from player.view.camera_animation import CameraPath, load_path, save_path
from tests.player.conftest import ClipMaker

DAYS = (0.0, 1.0, 3.0, 4.5)


def path_of(camera: Camera) -> CameraPath:
    path = CameraPath()
    for number, day in enumerate(DAYS):
        seen = camera.orbit(1.5 * number, 0.1 * number).zoom(1.0 + 0.5 * number).pan(0.05, 0.0)
        path = path.with_key(day, seen)
    return path


def close(a: Camera, b: Camera) -> bool:
    turned = math.remainder(a.yaw - b.yaw, 2 * math.pi)
    pairs = zip((*a.target, a.distance, a.pitch), (*b.target, b.distance, b.pitch), strict=True)
    return abs(turned) < 1e-6 and all(abs(x - y) < 1e-6 * (1 + abs(x)) for x, y in pairs)


def test_it_passes_through_every_key_and_rests_outside(make_clip: ClipMaker) -> None:
    path = path_of(Camera.home(make_clip()))
    for day, camera in path.keys:
        assert close(path.at(day), camera)
    assert close(path.at(-9.0), path.keys[0][1])
    assert close(path.at(99.0), path.keys[-1][1])


def test_it_has_no_jerk(make_clip: ClipMaker) -> None:
    path = path_of(Camera.home(make_clip()))
    days = np.linspace(DAYS[0], DAYS[-1], 2001)
    eyes = np.array([path.at(day).eye for day in days])
    speeds = np.linalg.norm(np.diff(eyes, axis=0), axis=1)
    assert np.abs(np.diff(speeds)).max() < 0.05 * speeds.max()


def test_it_goes_the_short_way_round() -> None:
    camera = Camera()
    path = (
        CameraPath()
        .with_key(0.0, replace(camera, yaw=3.0))
        .with_key(1.0, replace(camera, yaw=-3.0))
    )
    assert abs(path.at(0.5).yaw) == pytest.approx(math.pi, abs=1e-6)


def test_a_key_takes_the_place_of_one_of_the_same_day() -> None:
    path = (
        CameraPath().with_key(1.0, Camera()).with_key(0.0, Camera()).with_key(1.0, Camera(yaw=1.0))
    )
    assert [day for day, _ in path.keys] == [0.0, 1.0]
    assert path.keys[1][1].yaw == 1.0


def test_a_file_gives_the_same_path_even_about_another_origin(
    make_clip: ClipMaker, tmp_path: Path
) -> None:
    clip = replace(make_clip(), origin=(1000.0, -50.0, 3.0))
    path = path_of(Camera.home(clip))
    save_path(path, clip, tmp_path / "a.json")
    again = load_path(tmp_path / "a.json", clip)
    assert all(close(a[1], b[1]) for a, b in zip(path.keys, again.keys, strict=True))
    moved = load_path(tmp_path / "a.json", replace(clip, origin=(0.0, 0.0, 0.0)))
    assert np.allclose(moved.at(0.0).eye, path.at(0.0).eye + clip.origin)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d.pop("camera_path"), "missing required field `camera_path`"),
        (lambda d: d.update(up="y"), "up is 'y'; the clip's is 'z'"),
        (lambda d: d.update(keys=[]), r"keys is \[\]; .*length >= 1"),
        (lambda d: d["keys"][0].update(distance=0), r"keys 1.distance is 0; .*> 0"),
        (lambda d: d["keys"][1].update(target=[0, 1]), r"keys 2.target is \[0, 1\]; .*length 3"),
        (lambda d: d["keys"][0].update(yaw=True), r"keys 1.yaw is True; .*`float`"),
        (lambda d: d["keys"][0].update(yaw=10**400), r"keys 1.yaw is 1000"),
        (
            lambda d: d["keys"][0].update(field_of_view=180),
            r"1.field_of_view is 180; .*<= 150",
        ),
        (lambda d: d["keys"][1].update(day=0.0), "same day"),
        (lambda d: d["keys"].append(3), r"keys 5 is 3; .*`object`"),
    ],
)
def test_bad_files_are_refused_in_one_sentence(
    make_clip: ClipMaker, tmp_path: Path, change: object, message: str
) -> None:
    clip, file = make_clip(), tmp_path / "a.json"
    save_path(path_of(Camera.home(clip)), clip, file)
    document = json.loads(file.read_text())
    change(document)  # type: ignore[operator]
    file.write_text(json.dumps(document))
    with pytest.raises(UserError, match=message):
        load_path(file, clip)


@pytest.mark.parametrize("text", ["", "[]", "{", "[" * 100_000, "\x00"])
def test_garbage_is_refused(make_clip: ClipMaker, tmp_path: Path, text: str) -> None:
    (tmp_path / "a.json").write_text(text)
    with pytest.raises(UserError, match=r"a\.json"):
        load_path(tmp_path / "a.json", make_clip())


def test_files_without_an_end_are_not_read(make_clip: ClipMaker, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.json")
    (tmp_path / "zero.json").symlink_to("/dev/zero")
    with (tmp_path / "large.json").open("wb") as file:
        file.truncate(1 << 30)
    for name, said in (
        ("pipe", "regular"),
        ("zero", "regular"),
        ("large", "holds 1,073,741,824"),
    ):
        with pytest.raises(UserError, match=rf"{name}\.json.*{said}"):
            load_path(tmp_path / f"{name}.json", make_clip())


def test_a_film_follows_the_path(make_clip: ClipMaker) -> None:
    clip: Clip = make_clip()
    path = path_of(Camera.home(clip))
    film = Film(fps=5, seconds=2.0, path=path)
    for day, camera in zip(film.days(clip), film.cameras(clip), strict=True):
        assert close(camera, path.at(day))
    turning = replace(film, turning=True).cameras(clip)
    assert turning[5].yaw != film.cameras(clip)[5].yaw
