"""Keys and mouse change the scene; no window is needed to see it."""

import math
from dataclasses import replace

import pytest

from player.ui.actions import QUIT_NEXT
from player.ui.layout import PANEL, arrange
from player.view.camera import Camera
from player.view.playback import Timeline
from player.view.state import Scene
from player.view.style import Style
from player.window.input import Controls

TIMES = [0.0, 2.0, 3.0]


@pytest.fixture
def controls() -> Controls:
    camera = Camera()
    controls = Controls(Scene(Timeline.of(TIMES), camera, camera, Style(), has_colors=True))
    controls.layout = arrange((1000.0, 600.0), TIMES, ["a"] * 3, ["a"] * 3, lambda text, size: 9.0)
    return controls


def point_at(controls: Controls, day: float) -> tuple[float, float]:
    assert controls.layout is not None
    return controls.layout.x_of(day), controls.layout.line


def test_a_press_on_the_timeline_goes_there_and_a_drag_follows(controls: Controls) -> None:
    controls.move(*point_at(controls, 1.0))
    controls.press("left")
    assert controls.scene.timeline.day == pytest.approx(1.0)
    controls.move(point_at(controls, 2.6)[0], 10.0)
    assert controls.scene.timeline.day == pytest.approx(2.6)
    controls.move(-500.0, 10.0)
    assert controls.scene.timeline.day == 0.0
    controls.release("left")
    controls.move(*point_at(controls, 2.6))
    assert controls.scene.timeline.day == 0.0


def test_a_click_near_a_mark_means_the_scan(controls: Controls) -> None:
    x, y = point_at(controls, 2.0)
    controls.move(x + 3.0, y)
    controls.press("left")
    assert controls.scene.timeline.day == 2.0


def test_a_click_near_a_stroke_means_the_scan_that_was_left_out(controls: Controls) -> None:
    assert controls.layout is not None
    controls.layout = replace(controls.layout, strokes=(1.3,))
    x, y = point_at(controls, 1.3)
    controls.move(x + 3.0, y)
    controls.press("left")
    assert controls.scene.timeline.day == 1.3


@pytest.mark.parametrize(
    ("button", "shift", "turns"),
    [("left", False, True), ("left", True, False), ("right", False, False)],
)
def test_drags_turn_or_shift(controls: Controls, button: str, shift: bool, turns: bool) -> None:
    before = controls.scene.camera
    controls.move(500.0, 300.0)
    controls.press(button, shift)
    controls.move(560.0, 330.0)
    after = controls.scene.camera
    assert (after.yaw != before.yaw and after.pitch > before.pitch) == turns
    assert (after.target != before.target) == (not turns)
    controls.release(button)
    controls.move(100.0, 100.0)
    assert controls.scene.camera == after


def test_a_drag_of_the_plant_goes_on_over_the_timeline(controls: Controls) -> None:
    controls.move(500.0, 300.0)
    controls.press("left")
    controls.move(*point_at(controls, 2.0))
    assert controls.scene.timeline.day == 0.0


def test_the_wheel_comes_nearer_and_goes_back(controls: Controls) -> None:
    start = controls.scene.camera.distance
    controls.wheel(2.0)
    assert controls.scene.camera.distance < start
    controls.wheel(-2.0)
    assert controls.scene.camera.distance == pytest.approx(start)


def test_a_button_acts_on_release_if_the_cursor_is_still_there(controls: Controls) -> None:
    assert controls.layout is not None
    controls.move(*controls.layout.buttons["play"].middle)
    controls.press("left")
    assert not controls.scene.timeline.playing
    controls.release("left")
    assert controls.scene.timeline.playing
    controls.press("left")
    controls.move(500.0, 300.0)
    controls.release("left")
    assert controls.scene.timeline.playing


def test_every_button_can_be_hit(controls: Controls) -> None:
    assert controls.layout is not None
    for name, place in controls.layout.buttons.items():
        assert controls.layout.under(*place.middle) == name


def test_held_keys_repeat_only_where_that_makes_sense(controls: Controls) -> None:
    controls.key("g")
    controls.key("g", repeated=True)
    assert controls.scene.style.ground == "light"
    for _ in range(3):
        controls.key("right", repeated=True)
    assert controls.scene.timeline.share == pytest.approx(0.03)


def test_shifted_keys_fall_back_to_the_bare_key(controls: Controls) -> None:
    controls.key("right", shift=True)
    assert controls.scene.timeline.day == 2.0
    controls.key("end", shift=True)
    assert controls.scene.timeline.day == 3.0
    controls.key("z")  # in no table: nothing happens


def test_escape_leaves_one_thing_at_a_time(controls: Controls) -> None:
    controls.scene = replace(controls.scene, fullscreen=True, help=True)
    controls.key("escape")
    assert not controls.scene.help
    controls.key("escape")
    assert not controls.scene.fullscreen
    assert not controls.scene.closed
    controls.key("escape")
    assert not controls.scene.closed
    assert controls.scene.notice == QUIT_NEXT
    controls.key("escape")
    assert controls.scene.closed


def test_escape_once_leaves_a_kiosk(controls: Controls) -> None:
    controls.scene = replace(controls.scene, kiosk=True)
    controls.key("escape")
    assert controls.scene.closed


def test_a_click_closes_the_help_and_does_nothing_else(controls: Controls) -> None:
    controls.key("?")
    controls.move(*point_at(controls, 2.0))
    controls.press("left")
    controls.release("left")
    assert not controls.scene.help
    assert controls.scene.timeline.day == 0.0


def test_c_goes_through_the_colourings_that_the_clip_has(controls: Controls) -> None:
    seen = []
    for _ in range(5):
        controls.key("c")
        seen.append(controls.scene.color_mode)
    assert seen == ["track", "age", "speed", "height", "scan"]
    controls.scene = replace(controls.scene, has_colors=False)
    assert controls.scene.color_mode == "track"
    for _ in range(4):
        controls.key("c")
        assert controls.scene.color_mode != "scan"
    assert controls.scene.color_mode == "track"


def test_point_size_comes_back_to_one_and_has_limits(controls: Controls) -> None:
    for key in ("+", "+", "-", "-"):
        controls.key(key)
    assert controls.scene.style.point_size == 1.0
    for _ in range(100):
        controls.key("-")
    assert 0.0 < controls.scene.style.point_size < 1.0


def test_nothing_happens_before_the_first_picture() -> None:
    camera = Camera()
    controls = Controls(Scene(Timeline.of(TIMES), camera, camera, Style(), has_colors=True))
    controls.move(5.0, 5.0)
    controls.press("left")
    controls.release("left")
    controls.leave()
    assert controls.cursor is None


def test_a_click_on_the_panel_is_held_until_it_was_drawn(controls: Controls) -> None:
    controls.move(1100.0, 100.0)
    controls.press("left")
    controls.release("left")
    assert controls.held == PANEL, "no picture has shown it yet"
    touched = controls.touched
    controls.drawn()
    assert controls.held is None
    assert controls.touched > touched, "the panel is drawn again, and sees the button up"
    controls.press("left")
    controls.drawn()
    assert controls.held == PANEL
    controls.release("left")
    assert controls.held is None


def test_from_above_the_whole_plant_is_seen_unless_someone_came_nearer(controls: Controls) -> None:
    home = replace(controls.scene.home, radius=controls.scene.home.distance)
    controls.scene = replace(controls.scene, home=home, camera=home)
    for flat in (False, True):
        near = controls.scene.camera.distance
        controls.key("4")
        far = controls.scene.camera.distance
        assert far * math.tan(controls.scene.camera.field_of_view / 2) > home.radius
        controls.key("1")
        assert controls.scene.camera.distance == pytest.approx(near)
        if not flat:
            controls.key("5")
    controls.scene = controls.scene.seen(lambda camera: camera.zoom(1.5))
    nearer = controls.scene.camera.distance
    controls.key("4")
    assert controls.scene.camera.distance == nearer
