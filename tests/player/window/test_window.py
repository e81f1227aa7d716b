"""The real window, with real keys and a real mouse, on a display of its own (Xvfb, xdotool)."""

from pathlib import Path

import numpy as np
import pytest

from tests.player.shown import SIZE, Shown


def test_it_plays_by_itself_and_space_pauses(opened: Shown) -> None:
    first = opened.until(lambda state: state["playing"])
    opened.until(lambda state: state["day"] > first["day"] + 0.05)
    opened.point(320, 200)
    opened.key("space")
    assert not opened.until(lambda state: not state["playing"])["playing"]


def test_nothing_is_drawn_while_nothing_changes(shown: Shown) -> None:
    shown.settled(quiet=1.0)  # a busy machine may be late with pictures, but they come to an end
    pictures = len(shown.states)
    shown.key("g")
    shown.until(lambda state: len(shown.states) > pictures)
    shown.key("g")


def test_time_passes_at_the_clock_s_pace_not_the_frames_(shown: Shown) -> None:
    """By the clock of the window's own process: three days in four seconds."""
    shown.key("space")
    begin = shown.until(lambda state: state["playing"] and state["day"] > 0.1)
    end = shown.until(lambda state: state["day"] > begin["day"] + 1.2)
    days, seconds = (end[name] - begin[name] for name in ("day", "clock"))
    assert days == pytest.approx(0.75 * seconds, rel=0.2)


def test_a_click_on_a_scan_s_mark_goes_to_that_scan(shown: Shown) -> None:
    shown.click(*shown.on_line(2.0))
    shown.until(lambda state: state["day"] == 2.0)
    shown.until(lambda state: "2020-03-10" in shown.xdotool("getwindowfocus", "getwindowname"))


def test_dragging_the_timeline_scrubs_there_and_back(shown: Shown) -> None:
    start, (x, y) = shown.on_line(0.0), shown.on_line(1.3)
    shown.drag(1, start, (x, y - 60))
    state = shown.until(lambda state: state["day"] > 1.0)
    assert shown.settled()["day"] == pytest.approx(1.3, abs=0.02)
    assert state["at_home"]
    shown.drag(1, (x, y), (5, y))
    shown.until(lambda state: state["day"] == 0.0)


def test_keys_step_through_the_scans(shown: Shown) -> None:
    shown.key("Next")
    shown.until(lambda state: state["day"] == 2.0)
    shown.key("shift+Right")
    shown.until(lambda state: state["day"] == 3.0)
    shown.key("Prior", "Left")
    shown.until(lambda state: state["day"] == pytest.approx(1.97))
    shown.key("End")
    shown.until(lambda state: state["day"] == 3.0)


def test_left_drag_orbits(shown: Shown) -> None:
    before = shown.states[-1]
    shown.drag(1, (320, 200), (400, 240))
    after = shown.until(lambda state: state["pitch"] > before["pitch"] + 0.1)
    assert shown.settled()["yaw"] != before["yaw"]
    assert after["target"] == before["target"]
    shown.key("f")
    assert shown.until(lambda state: state["at_home"])["yaw"] == pytest.approx(before["yaw"])


@pytest.mark.parametrize("button", [2, 3, "shift"])
def test_right_middle_and_shift_drag_pan(shown: Shown, button: int | str) -> None:
    before = shown.states[-1]
    if button == "shift":
        shown.xdotool("keydown", "shift")
    shown.drag(1 if button == "shift" else int(button), (320, 200), (360, 160))
    if button == "shift":
        shown.xdotool("keyup", "shift")
    shown.until(lambda state: state["target"] != before["target"])
    after = shown.settled()
    assert (after["yaw"], after["pitch"]) == (before["yaw"], before["pitch"])


def test_the_wheel_zooms(shown: Shown) -> None:
    before = shown.states[-1]["distance"]
    shown.xdotool("click", "--repeat", 3, 4)
    shown.until(lambda state: state["distance"] < 0.8 * before)
    shown.xdotool("click", "--repeat", 3, 5)
    shown.until(lambda state: state["distance"] == pytest.approx(before))


def test_keys_change_the_look_the_speed_and_the_end(shown: Shown) -> None:
    was = shown.states[-1]
    shown.key("g", "c", "plus", "bracketright", "l")
    now = shown.until(lambda state: state["at_end"] != was["at_end"])
    assert (was["ground"], now["ground"]) == ("dark", "light")
    assert (was["color_by"], now["color_by"]) == ("scan", "track")
    assert now["point_size"] > was["point_size"]
    assert now["speed"] == 2 * was["speed"]
    shown.key("g", "c", "c", "c", "c", "c", "minus", "bracketleft", "l", "l")
    now = shown.until(lambda state: state["at_end"] == was["at_end"])
    same = ("ground", "color_by", "point_size", "speed")
    assert [now[name] for name in same] == [was[name] for name in same]


def test_the_play_button_plays(shown: Shown) -> None:
    shown.click(*shown.middle("play"))
    shown.until(lambda state: state["playing"] and state["day"] > 0.0)


def test_the_help_opens_and_escape_only_closes_it(shown: Shown) -> None:
    shown.key("question")
    shown.until(lambda state: state["help"])
    shown.key("Escape")
    shown.until(lambda state: not state["help"])
    assert shown.process.poll() is None


def test_a_screenshot_is_saved_where_the_user_stands(shown: Shown, clip_file: Path) -> None:
    from PIL import Image

    shown.key("s")
    notice = shown.until(lambda state: state["notice"].startswith("Saved"))["notice"]
    assert notice.endswith(str(clip_file.parent)), "the folder, too"
    with Image.open(clip_file.parent / notice.split()[1]) as picture:
        assert picture.size == SIZE
        assert len(np.unique(np.asarray(picture).reshape(-1, 3), axis=0)) > 20
