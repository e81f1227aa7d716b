"""Corrections made in an open window change the next bake."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import KDTree

import gclip
from baker.cli import main as bake
from corrections import corrections_file, read_corrections
from player.view.camera import Camera
from tests.player.shown import SIZE, Shown

DAYS = (0, 1, 2)


def arms(day: int, swapped: bool) -> np.ndarray:
    """(N, 4) x y z label: a stem with two arms, whose labels may change places; moved a little."""
    rng = np.random.default_rng(day)
    along = np.sort(rng.random((300, 1)), axis=0)
    noise = rng.normal(0, 0.05, (900, 3))
    stem = along * [0, 0, 20.0]
    left = along * [-8.0 - day, 0.0, 3.0] + [0, 0, 8.0]
    right = along * [5.0 + day, 1.0, 4.0] + [0, 0, 15.0]
    points = np.concatenate([stem, left, right]) + noise
    labels = np.repeat([0, 2, 1] if swapped else [0, 1, 2], 300)
    points[:, 0] += 100.0 + 0.5 * day
    return np.column_stack([points, labels])


@pytest.fixture
def clip(tmp_path: Path) -> Path:
    folder = tmp_path / "scans"
    folder.mkdir()
    for day in DAYS:
        np.savetxt(folder / f"day{day}.txt", arms(day, swapped=day == 2), fmt="%.4f")
    assert bake_again(tmp_path) == 0
    return tmp_path / "plant.gclip"


def bake_again(folder: Path) -> int:
    words = [str(folder / "scans"), "-o", str(folder / "plant.gclip"), "--align", "icp", "-q"]
    return bake([*words, "--up", "z", "--labels", "consistent", "--force"])


def leftmost(clip: Path, day: float) -> str:
    """The name of the organ whose tip is farthest to the left."""
    opened = gclip.open(clip)
    frame = opened.at(day)
    return opened.track_table[frame.tracks[frame.positions[:, 0].argmin()]].name


def on_screen(shown: Shown, clip: Path, day: float, name: str) -> tuple[float, float]:
    """Where the middle of an organ is seen."""
    state, opened = shown.states[-1], gclip.open(clip)
    camera = Camera.home(opened)
    home = Camera(
        tuple(state["target"]), state["distance"], state["yaw"], state["pitch"],
        up=opened.up, radius=camera.radius,
    )  # fmt: skip
    frame = opened.at(day)
    points = frame.local[frame.tracks == opened.tracks[name].id]
    middle = points[np.linalg.norm(points - points.mean(axis=0), axis=1).argmin()]
    right, up, _, scale = home.matrix(SIZE[0] / SIZE[1]) @ [*middle, 1.0]
    return (1 + right / scale) * SIZE[0] / 2, (1 - up / scale) * SIZE[1] / 2


def test_corrections_made_in_the_window_change_the_next_bake(
    clip: Path, display: dict[str, str]
) -> None:
    assert leftmost(clip, 0.0) == leftmost(clip, 1.0) == "leaf 1"
    assert leftmost(clip, 2.0) == "leaf 2", "the labels say so"
    file = corrections_file(clip)
    shown = Shown(display, clip, SIZE)
    try:
        shown.until(lambda state: True)
        shown.key("space", "Home")
        shown.until(lambda state: not state["playing"] and state["day"] == 0.0)
        shown.click(*on_screen(shown, clip, 0.0, "leaf 1"))
        shown.until(lambda state: state["picked"] == 1)
        shown.key("End")
        shown.until(lambda state: state["day"] == 2.0)
        x, y = on_screen(shown, clip, 2.0, "leaf 2")
        shown.xdotool("mousemove", round(x), round(y), "keydown", "shift", "click", 1)
        shown.xdotool("keyup", "shift")
        shown.until(lambda state: state["second"] == 2)
        shown.key("w")
        shown.until(lambda state: "bake again" in state["notice"])
        shown.until(lambda _: file.exists())
        (same,) = read_corrections(file)
        assert [place.scan for place in same.places] == ["day0.txt", "day2.txt"]
        for place in same.places:  # in the file's own coordinates, though the scans were aligned
            scan = np.loadtxt(clip.parent / "scans" / place.scan)
            distance, nearest = KDTree(scan[:, :3]).query(place.point)
            assert distance < 0.01
            assert scan[nearest, 3] == (1 if place is same.places[0] else 2)
        shown.key("ctrl+z")
        shown.until(lambda _: read_corrections(file) == ())
        shown.key("ctrl+shift+z")
        shown.until(lambda _: read_corrections(file) == (same,))
        assert bake_again(clip.parent) == 0
        shown.until(lambda state: "has been reloaded" in state["notice"])
    finally:
        shown.end()
    assert {leftmost(clip, day) for day in (0.0, 1.0, 2.0)} == {"leaf 1"}


def test_a_file_of_corrections_that_makes_no_sense_is_told_and_left_alone(
    clip: Path, display: dict[str, str]
) -> None:
    file = corrections_file(clip)
    file.write_text("[[correction]]\nkind = 'trim'\n")
    shown = Shown(display, clip, SIZE)
    try:
        shown.until(lambda state: "correction 1" in state["notice"])
        shown.key("n", "shift+c")
        shown.until(lambda state: state["picked"] == 0 and "first" in state["notice"])
    finally:
        shown.end()
    assert "trim" in file.read_text()
