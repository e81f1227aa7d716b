"""What the mouse does: to the plant, to the timeline, and to every control."""

from collections.abc import Iterator
from dataclasses import replace

import moderngl
import pytest

from corrections import Correction, Place
from corrections.history import Edits
from player.ui import keys
from player.view.camera_animation import CameraPath
from player.view.choices import Compare
from shaders.effects import EFFECTS
from tests.player.desk import Desk, scene_of
from tests.player.shown import small_clip

PLANT = (300.0, 250.0)

# What has no control of its own: the timeline, or a control for the neighbour, does as much.
KEYS_ALONE = {
    "back", "on", "frame back", "frame on", "first", "last", "next organ",
    "last organ", "wipe left", "wipe right", "leave", "quit",
}  # fmt: skip
CHOICES = {
    "color",
    "colormap",
    "compare",
    "curve",
    "format",
    "size",
}  # lists, where the key goes through the choices

# and sliders, with the fields of a style that they change.
SLIDERS = {"points": "point_size"} | {one.name: one.name for one in EFFECTS if not one.is_switch}


@pytest.fixture
def desk(context: moderngl.Context) -> Iterator[Desk]:
    desk = Desk(context, small_clip(), size=(900.0, 1200.0), scale=0.5)
    yield desk
    desk.release()


def test_a_press_on_the_timeline_goes_there_and_a_drag_follows(desk: Desk) -> None:
    line = desk.line
    desk.point((line.x_of(1.0), line.height))
    desk.press("left", True)
    assert desk.draw(2).timeline.day == pytest.approx(1.0, abs=0.01)
    assert desk.interface.timeline.dragging
    desk.move(line.x_of(2.6), 10.0)
    assert desk.draw(2).timeline.day == pytest.approx(2.6, abs=0.01)
    desk.move(-500.0, 10.0)
    assert desk.draw(2).timeline.day == 0.0
    desk.press("left", False)
    desk.draw(2)
    assert not desk.interface.timeline.dragging
    desk.move(line.x_of(2.6), line.height)
    assert desk.draw(2).timeline.day == 0.0


def test_a_click_near_a_mark_means_the_scan(desk: Desk) -> None:
    desk.click((desk.line.x_of(2.0) + 3.0, desk.line.height))
    assert desk.scene.timeline.day == 2.0


@pytest.mark.parametrize(
    ("button", "shift", "turns"),
    [
        ("left", False, True),
        ("left", True, False),
        ("right", False, False),
        ("middle", False, False),
    ],
)
def test_drags_turn_or_shift(desk: Desk, button: str, shift: bool, turns: bool) -> None:
    before = desk.scene.camera
    after = desk.drag(PLANT, (360.0, 280.0), button, shift).camera
    assert (after.yaw != before.yaw and after.pitch > before.pitch) == turns
    assert (after.target != before.target) == (not turns)
    desk.point((100.0, 100.0))
    assert desk.scene.camera == after, "it was let go"
    assert desk.clicked is None


def test_a_drag_of_the_plant_goes_on_over_the_timeline(desk: Desk) -> None:
    desk.drag(PLANT, (desk.line.x_of(2.0), desk.line.height))
    assert desk.scene.timeline.day == 0.0
    assert desk.scene.camera != desk.scene.home


def test_a_click_on_the_plant_is_told_and_turns_nothing(desk: Desk) -> None:
    desk.click(PLANT)
    assert desk.clicked == PLANT
    assert desk.scene.camera == desk.scene.home


@pytest.mark.parametrize("shift", [False, True])
def test_a_click_turns_nothing_however_fast_the_mouse_came(desk: Desk, shift: bool) -> None:
    """The mouse may have moved and pressed between two pictures."""
    desk.point((40.0, 60.0))
    desk.move(*PLANT)
    desk.press("left", True, shift)
    desk.draw()
    desk.press("left", False, shift)
    desk.draw(2)
    assert desk.scene.camera == desk.scene.home
    assert desk.clicked == PLANT


def test_a_drag_turns_the_plant_however_fast_it_is(desk: Desk) -> None:
    """The mouse may have moved and let go between two pictures."""
    desk.point(PLANT)
    desk.press("left", True)
    desk.draw()
    desk.move(360.0, 280.0)
    desk.press("left", False)
    desk.draw(3)
    assert desk.scene.camera.yaw != desk.scene.home.yaw
    assert desk.scene.camera.target == desk.scene.home.target
    assert desk.clicked is None


def test_the_wheel_comes_nearer_and_goes_back(desk: Desk) -> None:
    start = desk.scene.camera.distance
    desk.point(PLANT)
    assert desk.wheel(2.0).camera.distance < start
    assert desk.wheel(-2.0).camera.distance == pytest.approx(start)


def test_a_button_acts_on_release_if_the_cursor_is_still_there(desk: Desk) -> None:
    desk.point("play")
    desk.press("left", True)
    assert not desk.draw(2).timeline.playing
    desk.press("left", False)
    assert desk.draw(2).timeline.playing
    desk.drag("play", PLANT)
    assert desk.scene.timeline.playing


def test_the_wipe_is_dragged(desk: Desk) -> None:
    desk.scene = replace(desk.scene, compare=Compare.WIPE)
    desk.draw(2)
    desk.drag("line", (0.25 * desk.size[0], 300.0))
    assert desk.scene.wipe == pytest.approx(0.25, abs=0.01)
    assert desk.scene.camera == desk.scene.home
    desk.drag("line", (-100.0, 300.0))
    assert desk.scene.wipe == 0.02


def test_a_click_closes_the_help_and_does_nothing_else(desk: Desk) -> None:
    desk.scene = replace(desk.scene, help=True)
    desk.draw(3)
    desk.click((desk.line.x_of(2.0), desk.line.height))
    assert not desk.scene.help
    assert desk.scene.timeline.day == 0.0
    assert desk.clicked is None


def opened(desk: Desk) -> None:
    """With the panel, all of its sections, and all that they may show."""
    path = CameraPath(((0.0, desk.scene.camera), (2.0, desk.scene.camera)))
    style = replace(desk.scene.style, picked=1)
    output = replace(desk.scene.output, example="still.png")
    changes = {"panel": True, "path": path, "style": style, "output": output, "curve": ""}
    desk.scene = replace(desk.scene, **changes)  # type: ignore[arg-type]
    desk.draw(3)
    for title in ("View", "Compare", "Corrections"):
        desk.click(title)


@pytest.mark.parametrize("panel", [False, True])
def test_every_control_does_its_action(context: moderngl.Context, panel: bool) -> None:
    desk = Desk(context, small_clip(), size=(1280.0, 1200.0), scale=0.25)
    if panel:
        opened(desk)
        missing = set(keys.ACTIONS) - set(desk.places)
        assert missing == KEYS_ALONE | {"field"}, "the clip has no fields"
    before = desk.scene
    for action in keys.ACTIONS.values():
        slider = panel and action.name in SLIDERS
        if action.name in desk.places and not slider and not (panel and action.name in CHOICES):
            desk.click(action.name)
            assert desk.scene == action.do(before), action.name
            desk.scene = before
            desk.draw()
    desk.release()


@pytest.mark.parametrize(("action", "value"), SLIDERS.items())
def test_sliders_go_from_end_to_end(desk: Desk, action: str, value: str) -> None:
    desk.scene = replace(desk.scene, panel=True)
    desk.draw(3)
    left, top, right, bottom = desk.places[action]
    middle = (top + bottom) / 2
    desk.drag((left + 20.0, middle), (right + 300.0, middle))
    high = getattr(desk.scene.style, value)
    desk.drag((left + 30.0, middle), (left - 300.0, middle))
    low = getattr(desk.scene.style, value)
    assert low <= getattr(scene_of(desk.clip).style, value) <= high
    assert low < high


@pytest.mark.parametrize("action", sorted(CHOICES))
def test_lists_choose(desk: Desk, action: str) -> None:
    opened(desk)
    before = desk.scene
    desk.click(action)
    assert desk.gui.captures("escape")
    desk.gui.send_key("escape")
    desk.draw(3)
    assert not desk.gui.captures("escape"), "Esc closes it"
    assert desk.scene == before
    desk.click(action)
    names = {
        "color": "organs", "colormap": "magma", "compare": "wipe", "curve": "area",
        "format": "film.webm", "size": "1280 × 720",
    }  # fmt: skip
    desk.click(names[action])
    assert not desk.gui.captures("escape")
    assert desk.scene != before


def test_organs_are_picked_and_hidden_in_the_list(desk: Desk) -> None:
    desk.scene = replace(desk.scene, panel=True)
    desk.draw(3)
    left, top, _, bottom = desk.places["##name"]  # the last one's
    desk.click((left + 30.0, (top + bottom) / 2))
    assert desk.scene.style.picked == 1
    desk.click((left - 35.0, (top + bottom) / 2))  # its eye
    assert desk.scene.style.hidden == {1}


def test_the_panel_scrolls_as_a_whole_and_leaves_the_plant_alone(desk: Desk) -> None:
    desk.scene, desk.size = replace(desk.scene, panel=True), (900.0, 400.0)
    desk.draw(3)
    before, high = desk.scene.camera, desk.places["color"][1]
    desk.point("color")
    desk.wheel(-3.0)
    assert desk.scene.camera == before
    assert desk.places["color"][1] < high


def test_what_was_put_right_is_listed_and_taken_out(desk: Desk) -> None:
    places = [Place(f"{day}.ply", (0.0, 0.0, 1.0), f"leaf {day}") for day in (1, 2)]
    said = Correction("same", tuple(places)), Correction("cut", (places[0],))
    picked = replace(desk.scene.style, picked=1)
    desk.scene = replace(desk.scene, panel=True, style=picked, clicked_places=tuple(places))
    desk.scene = replace(desk.scene, edits=Edits((said,)))
    desk.draw(3)
    assert {"same", "different", "cut"} <= desk.places.keys(), "two organs open the section"
    left, bottom = desk.places["same"][0], desk.places["redo"][3]
    desk.click((left + 10.0, bottom + 55.0))  # under the two organs' names
    assert desk.scene.edits == Edits((said,)).changed(said[1:])


def test_an_organ_is_named_in_the_panel(context: moderngl.Context) -> None:
    desk = Desk(context, small_clip(), size=(900.0, 900.0), scale=0.25)
    place = Place("a.ply", (0.0, 0.0, 1.0), "leaf")
    picked = replace(desk.scene.style, picked=1)
    changes = {"style": picked, "clicked_places": (place,), "edits": Edits()}
    desk.scene = replace(desk.scene, panel=True, **changes)
    desk.draw(3)
    desk.click("##called")
    assert desk.gui.captures("a")
    for key in ("F", "l", "a", "g", "x", "backspace", "enter"):
        desk.gui.send_key(key)
        desk.draw(3)
    assert not desk.gui.captures("a")
    assert desk.scene.edits is not None
    assert desk.scene.edits.current == (Correction("name", (place,), "Flag"),)
    desk.release()
