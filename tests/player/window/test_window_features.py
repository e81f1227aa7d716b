"""What the window can do beyond playing: by mouse and keys, as a user would."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from player.ui.panel import WIDTH
from player.view.camera import Camera
from player.view.camera_animation import CameraPath, save_path
from tests.player.shown import DATES, TIMES, Shown, small_clip

SIZE = (900, 600)
LATER = (1.0, *TIMES[1:])

# Organs are measured long after the last event.
SLOW = """
import time
from player.ui import organ_info
measured = organ_info.trait_curves

def trait_curves(*given):
    time.sleep(2.0)
    return measured(*given)

organ_info.trait_curves = trait_curves
"""

# Values of movers take seconds in large clips.
ONCE = """
import traits
compute, computed = traits.growth_rates, []

def growth_rates(clip):
    assert not computed, "computed again"
    computed.append(clip)
    return compute(clip)

traits.growth_rates = growth_rates
"""


@pytest.fixture(scope="module")
def opened(display: dict[str, str], clip_file: Path) -> Iterator[Shown]:
    shown = Shown(display, clip_file, SIZE, panel=True)
    yield shown
    shown.end()


@pytest.fixture
def shown(opened: Shown) -> Shown:
    """Paused at the first scan, seen from home, nothing picked, the mouse on the background."""
    opened.point(20, 200)
    if opened.states[-1]["playing"]:
        opened.key("space")
        opened.until(lambda state: not state["playing"])
    opened.key("Home", "f")
    opened.until(lambda state: state["day"] == 0.0 and state["at_home"])
    return opened


def test_tab_opens_and_closes_the_panel_and_the_plant_has_the_rest(shown: Shown) -> None:
    narrow = shown.states[-1]
    shown.key("Tab")
    wide = shown.until(lambda state: not state["panel"])
    assert wide["at_home"]
    shown.click(*shown.on_line(2.0))
    shown.until(lambda state: state["day"] == 2.0)
    shown.click(*shown.middle("panel"))
    shown.until(lambda state: state["panel"] and state["home"] == narrow["home"])


def test_the_panel_s_controls_work_and_leave_the_plant_alone(shown: Shown) -> None:
    before = shown.states[-1]
    shown.click(*shown.middle("floor"))
    after = shown.until(lambda state: state["floor"] != before["floor"])
    assert (after["yaw"], after["target"]) == (before["yaw"], before["target"])
    shown.xdotool("click", "--repeat", 3, 5)  # scrolls the panel; nothing comes nearer
    assert shown.settled()["distance"] == before["distance"]
    shown.key("b")
    shown.until(lambda state: state["floor"] == before["floor"])


def test_organs_are_picked_hidden_and_shown(shown: Shown) -> None:
    shown.click((SIZE[0] - WIDTH) / 2, 290)
    picked = shown.until(lambda state: state["picked"] is not None)["picked"]
    shown.key("z")
    shown.until(lambda state: state["alone"] == picked)
    shown.key("z", "x")
    shown.until(lambda state: state["hidden"] == [picked] and state["picked"] is None)
    shown.key("shift+x", "n")
    shown.until(lambda state: state["hidden"] == [] and state["picked"] == 0)
    shown.key("shift+n")
    shown.until(lambda state: state["picked"] == 1)
    shown.click(20, 150)
    shown.until(lambda state: state["picked"] is None)


def test_a_curve_appears_as_soon_as_it_is_measured(
    display: dict[str, str], clip_file: Path
) -> None:
    shown = Shown(display, clip_file, SIZE, before=SLOW)
    try:
        shown.point(20, 200)
        shown.key("space", "n")
        shown.until(lambda state: state["picked"] == 0)
        shown.until(lambda state: "curve" in state["places"], 30.0)
    finally:
        shown.end()


def test_plant_and_legend_share_the_values_that_are_computed(
    display: dict[str, str], clip_file: Path
) -> None:
    shown = Shown(display, clip_file, SIZE, before=ONCE, legend=True)
    try:
        shown.point(20, 200)
        shown.key("space", "c", "c", "c")
        shown.until(lambda state: state["color_by"] == "growth", 40.0)
        shown.settled()
        assert shown.process.poll() is None
    finally:
        shown.end()


def test_the_wheel_goes_to_the_cursor(shown: Shown) -> None:
    before = shown.settled(1.0)  # a plot that closes makes room in the next picture
    shown.point(480, 200)
    shown.xdotool("click", "--repeat", 3, 4)
    after = shown.until(lambda state: state["distance"] < 0.8 * before["distance"])
    assert after["target"] != before["target"]
    shown.xdotool("click", "--repeat", 3, 5)
    back = shown.until(lambda state: state["distance"] == pytest.approx(before["distance"]))
    assert np.allclose(back["target"], before["target"])


def test_views_and_projections(shown: Shown) -> None:
    before = shown.states[-1]
    shown.key("4")
    assert shown.until(lambda state: state["pitch"] > 1.5)
    shown.key("1", "5")
    state = shown.until(lambda state: state["flat"] and state["pitch"] == 0.0)
    assert state["yaw"] == pytest.approx(before["yaw"])
    shown.key("5")
    shown.until(lambda state: not state["flat"])


def test_the_wipe_is_dragged(shown: Shown) -> None:
    shown.key("v")
    shown.until(lambda state: state["compare"] == "wipe")
    width = SIZE[0] - WIDTH
    before = shown.states[-1]
    shown.drag(1, (width / 2, 300), (width / 4, 310))
    state = shown.until(lambda state: abs(state["wipe"] - 0.25) <= 0.02)
    assert state["yaw"] == before["yaw"]
    shown.key("v", "v")
    shown.until(lambda state: state["compare"] == "off")


def test_a_camera_path_is_made_and_followed(shown: Shown, clip_file: Path) -> None:
    shown.key("k")
    shown.until(lambda state: "1 key" in state["notice"])
    shown.key("End", "2", "k")
    shown.until(lambda state: state["keys"] == 2)
    shown.key("j")
    shown.until(lambda state: state["following"])
    shown.key("Home")
    start = shown.until(lambda state: state["day"] == 0.0)
    shown.key("Next")
    middle = shown.until(lambda state: state["day"] == 2.0)
    assert middle["yaw"] != start["yaw"]
    shown.drag(1, (20, 200), (60, 200))
    shown.until(lambda state: not state["following"])
    saved = json.loads((clip_file.parent / "plant.camera.json").read_text())
    assert [key["day"] for key in saved["keys"]] == [TIMES[0], TIMES[-1]]


def test_a_transparent_picture_of_what_is_seen(shown: Shown, clip_file: Path) -> None:
    from PIL import Image

    shown.key("shift+s", "s")
    notice = shown.until(lambda state: state["notice"].startswith("Saved"), 60.0)["notice"]
    with Image.open(clip_file.parent / notice.removeprefix("Saved ").split(" in ")[0]) as picture:
        alpha = np.asarray(picture.convert("RGBA"))[..., 3]
        assert picture.size == (SIZE[0] - WIDTH, SIZE[1])
    assert DATES[0] in notice  # as pictures of the window are named
    assert alpha[0, 0] == 0
    assert alpha.max() == 255
    shown.key("shift+s")


def test_a_stopped_export_leaves_nothing(shown: Shown, clip_file: Path) -> None:
    shown.key("e")
    shown.until(lambda state: state["notice"].startswith("Exporting"))
    before = set(clip_file.parent.iterdir())
    shown.key("e")
    shown.until(lambda state: state["notice"].startswith("Stopped"), 60.0)
    after = {path.name for path in clip_file.parent.iterdir()}
    assert after <= {path.name for path in before}
    assert not [name for name in after if "mp4" in name]


def test_what_is_baked_anew_is_shown_anew(
    display: dict[str, str], clip_file: Path, tmp_path: Path
) -> None:
    own = tmp_path / "own.gclip"
    shutil.copy(clip_file, own)
    shown = Shown(display, own, (500, 400))
    try:
        again = tmp_path / "again"
        again.write_bytes(b"not a clip")
        os.replace(again, own)
        shown.until(lambda state: "own.gclip" in state["notice"])
        small_clip(times=LATER).save(own)
        state = shown.until(lambda state: "has been reloaded" in state["notice"])
        assert state["times"] == list(LATER)
    finally:
        shown.end()


def test_two_clips_in_step(display: dict[str, str], clip_file: Path) -> None:
    shown = Shown(display, [clip_file, clip_file], (700, 400))
    try:
        assert shown.until(lambda state: state["day"] > 0.0)["compare"] == "side by side"
    finally:
        shown.end()


def dropped(shown: Shown, *files: Path) -> None:
    drag = [sys.executable, "-m", "tests.player.drag", *map(str, files)]
    subprocess.run(drag, env=shown.environment, check=True, cwd=Path(__file__).parents[3])


def test_dropped_files_are_opened(display: dict[str, str], clip_file: Path, tmp_path: Path) -> None:
    """Really dragged; what can't be shown leaves the clip that is there, and one sentence."""
    other, broken = tmp_path / "ein andörer 100%.gclip", tmp_path / "broken.gclip"
    small_clip(times=LATER).save(other)
    broken.write_bytes(other.read_bytes()[:-50])
    shown = Shown(display, clip_file, (500, 400))
    try:
        dropped(shown, broken)
        told = shown.until(lambda state: "broken.gclip" in state["notice"])
        assert told["times"] == list(TIMES)
        assert told["notice"].startswith("broken.gclip: "), "no folders"
        dropped(shown, other)
        told = shown.until(lambda state: "Opened ein andörer 100%" in state["notice"])
        assert told["times"][0] == 1.0
        dropped(shown, tmp_path)
        told = shown.until(lambda state: "not a growth clip" in state["notice"])
        assert told["times"][0] == 1.0
        dropped(shown, tmp_path / "missing.gclip")
        shown.until(lambda state: "missing.gclip" in state["notice"])
        dropped(shown, clip_file, other)
        shown.until(lambda state: state["compare"] == "side by side")
    finally:
        shown.end()


def test_a_dropped_camera_path_is_followed(
    display: dict[str, str], clip_file: Path, tmp_path: Path
) -> None:
    """As by --camera, also with the clip that it belongs to; others are refused in one sentence."""
    file, clip = tmp_path / "round.JSON", small_clip()
    path = CameraPath().with_key(TIMES[0], Camera.home(clip)).with_key(TIMES[-1], Camera())
    save_path(path, clip, file)
    (tmp_path / "sideways.json").write_text(file.read_text().replace('"z"', '"-x"'))
    shown = Shown(display, clip_file, (500, 400))
    try:
        shown.key("t")
        shown.until(lambda state: state["turning"])
        dropped(shown, tmp_path / "sideways.json")
        told = shown.until(lambda state: state["notice"].startswith("sideways.json: up is"))
        assert (told["keys"], told["turning"]) == (0, True)
        for files in ([file], [file, clip_file]):
            dropped(shown, *files)
            told = shown.until(lambda state: state["notice"] == "Opened round.JSON, 2 keys")
            assert (told["keys"], told["following"], told["turning"]) == (2, True, False)
            shown.key("j")
            shown.until(lambda state: not state["following"] and not state["notice"])
    finally:
        shown.end()
