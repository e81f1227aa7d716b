"""Keys change the scene; no window is needed to see it."""

import math
from dataclasses import replace

import pytest

from corrections import Place
from corrections.history import Edits
from player.ui import actions, keys
from player.ui.actions import QUIT_NEXT
from player.view.camera import Camera
from player.view.camera_animation import CameraPath
from player.view.choices import Compare
from player.view.playback import AtEnd, Timeline
from player.view.state import Scene
from player.view.style import Style
from tests.player.shown import small_clip

TIMES = [0.0, 2.0, 3.0]


@pytest.fixture
def scene() -> Scene:
    camera = Camera()
    return Scene(Timeline.of(TIMES), camera, camera, Style(), (small_clip("abc", TIMES),))


def pressed(scene: Scene, *names: str) -> Scene:
    for name in names:
        scene = keys.apply_key(scene, name.removeprefix("shift+"), name.startswith("shift+"))
    return scene


@pytest.mark.parametrize("action", keys.ACTIONS.values(), ids=lambda action: action.name)
def test_every_action_by_each_of_its_keys(scene: Scene, action: keys.Action) -> None:
    """From a state in which each of them does something."""
    scene = pressed(scene, "right", "n", "end")
    path = CameraPath(((0.0, scene.camera),))
    scene = replace(scene, compare=Compare.WIPE, notice="told", path=path)
    scene = replace(scene, timeline=replace(scene.timeline.at(1.5), at_end=AtEnd.STOP))
    if action.name in ("first", "front"):
        scene = scene.with_camera(lambda camera: camera.orbit(0.3, 0.3))
    if action.name in ("fit", "show all"):
        scene = scene.with_style(hidden=frozenset({0})).with_camera(lambda camera: camera.zoom(2.0))
    places = Place("a.ply", (0.0, 0.0, 1.0), "leaf 1"), Place("b.ply", (0.0, 0.0, 2.0), "leaf 2")
    scene = replace(scene, clicked_places=places, edits=Edits())
    if action.name in ("undo", "redo"):
        scene = actions.correct(scene, "same")
    if action.name == "redo":
        scene = pressed(scene, "ctrl+z")
    wanted = action.do(scene)
    assert wanted != scene
    for key in action.keys.split():
        assert pressed(scene, key) == wanted


def test_held_keys_repeat_only_where_that_makes_sense(scene: Scene) -> None:
    scene = keys.apply_key(scene, "g")
    scene = keys.apply_key(scene, "g", repeated=True)
    assert scene.style.ground == "light"
    for _ in range(3):
        scene = keys.apply_key(scene, "right", repeated=True)
    timeline = scene.timeline
    assert timeline.day == pytest.approx(timeline.first + 0.03 * (timeline.last - timeline.first))


def test_shifted_keys_fall_back_to_the_bare_key(scene: Scene) -> None:
    scene = pressed(scene, "shift+right")
    assert scene.timeline.day == 2.0
    scene = pressed(scene, "shift+end")
    assert scene.timeline.day == 3.0
    assert pressed(scene, "f12") == scene, "in no table: nothing happens"


def test_escape_leaves_one_thing_at_a_time(scene: Scene) -> None:
    scene = pressed(replace(scene, fullscreen=True, help=True), "escape")
    assert not scene.help
    scene = pressed(scene, "escape")
    assert not scene.fullscreen
    assert not scene.closed
    scene = pressed(scene, "escape")
    assert not scene.closed
    assert scene.notice == QUIT_NEXT
    assert pressed(scene, "escape").closed


def test_shift_m_goes_through_the_colour_maps(scene: Scene) -> None:
    assert pressed(scene, "shift+m").style.color_map == "viridis"


def test_c_goes_through_the_colourings_that_the_clip_has(scene: Scene) -> None:
    seen = []
    for _ in range(6):
        scene = pressed(scene, "c")
        seen.append(scene.color_mode)
    assert seen == ["track", "age", "growth", "speed", "height", "scan"]
    bare = [replace(one, start_colors=None, end_colors=None) for one in scene.clip.intervals]
    scene = replace(scene, clips=(replace(scene.clip, intervals=tuple(bare)),))
    assert scene.color_mode == "track"
    for _ in range(5):
        scene = pressed(scene, "c")
        assert scene.color_mode != "scan"
    assert scene.color_mode == "track"


def test_point_size_comes_back_to_one_and_has_limits(scene: Scene) -> None:
    scene = pressed(scene, "+", "+", "-", "-")
    assert scene.style.point_size == 1.0
    scene = pressed(scene, *["-"] * 100)
    assert 0.0 < scene.style.point_size < 1.0


def test_from_above_the_whole_plant_is_seen_unless_someone_came_nearer(scene: Scene) -> None:
    home = replace(scene.home, radius=scene.home.distance)
    scene = replace(scene, home=home, camera=home)
    for flat in (False, True):
        near = scene.camera.distance
        scene = pressed(scene, "4")
        assert scene.camera.distance * math.tan(scene.camera.field_of_view / 2) > home.radius
        scene = pressed(scene, "1")
        assert scene.camera.distance == pytest.approx(near)
        if not flat:
            scene = pressed(scene, "5")
    nearer = scene.with_camera(lambda camera: camera.zoom(1.5))
    assert pressed(nearer, "4").camera.distance == nearer.camera.distance


def test_corrections_are_undone_and_made_again(scene: Scene) -> None:
    one, two = Place("a.ply", (0.0, 0.0, 1.0), "leaf 1"), Place("b.ply", (0.0, 0.0, 2.0), "leaf 2")
    scene = replace(scene, edits=Edits())
    assert "first" in actions.correct(scene, "cut").notice
    scene = actions.pick(scene, 0, one)
    assert "another" in actions.correct(scene, "same").notice
    scene = actions.pick(scene, 1, two, add=True)
    assert (scene.style.picked, scene.style.second, scene.clicked_places) == (0, 1, (one, two))
    missed = actions.pick(scene, None, add=True)
    assert (missed.style.picked, missed.style.second, missed.clicked_places) == (0, None, (one,))
    scene = pressed(scene, "shift+w", "shift+c")
    scene = actions.correct(scene, "name", "flag leaf")
    assert scene.edits is not None
    different, cut, name = scene.edits.current
    assert (different.kind, different.places) == ("different", (one, two))
    assert (cut.kind, cut.places) == ("cut", (one,))
    assert (name.kind, name.places, name.name) == ("name", (one,), "flag leaf")
    undone = pressed(scene, "ctrl+z", "ctrl+z")
    assert undone.edits is not None
    assert undone.edits.current == (different,)
    assert pressed(undone, "shift+ctrl+z").edits.current == (different, cut)  # type: ignore[union-attr]
    assert pressed(undone, "w", "shift+ctrl+z").edits.current[0] == different  # type: ignore[union-attr]
    assert actions.pick(scene, 0).clicked_places == (), "a second click lets go"
    assert pressed(replace(scene, edits=None), "w").edits is None, "no file to keep them in"
