"""What lies over the plant: where it stands, and that it is drawn (EGL)."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import combinations, pairwise
from typing import Any

import moderngl
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from imgui_bundle import imgui

from gclip import Clip
from player.ui.theme import DARK, LIGHT, Pen, one_line
from player.ui.timeline import Line, fitting_labels
from player.view.state import ExportProgress, Scene
from player.view.style import ColorMode
from tests.player.desk import SIZE, Desk, scene_of
from tests.player.shown import small_clip
from traits.curves import TraitCurve

TIMES = st.lists(st.integers(0, 5000), min_size=2, max_size=60, unique=True).map(sorted)
WIDTHS = st.floats(320, 4000)


@contextmanager
def opened(context: moderngl.Context, clip: Clip, *rest: Any, **named: Any) -> Iterator[Desk]:
    desk = Desk(context, clip, *rest, **named)
    yield desk
    desk.release()


def drawn(desk: Desk, scene: Scene, at: tuple[float, float] | None = None) -> np.ndarray:
    """A scene's pixels, with the mouse at a place, or nowhere."""
    desk.scene = scene
    desk.leave()
    if at is not None:
        desk.point(at)
    return desk.pixels().copy()


@given(WIDTHS, TIMES)
def test_dates_neither_touch_nor_leave_the_window(width: float, times: list[int]) -> None:
    line = Line(150.0, max(width - 150.0, 151.0), 400.0, tuple(times))
    half = 30.0
    dates, ends = ["2020-03-08"] * len(times), (8.0, width - 8.0)
    labels = fitting_labels(line, dates, ends, lambda text: 2 * half)
    assert labels[0][0] == 0
    for _, x in labels:
        assert x - half >= 8.0
        assert x + half <= width - 8.0
    for (_, left), (_, right) in pairwise(labels):
        assert left + half < right - half


@given(WIDTHS, TIMES, st.floats(0, 1))
def test_the_day_under_a_day_s_place_is_that_day(
    width: float, times: list[int], share: float
) -> None:
    line = Line(50.0, width - 100.0, 400.0, tuple(times))
    day = times[0] + share * (times[-1] - times[0])
    a_few_units = 5.0 * (times[-1] - times[0]) / (line.right - line.left)
    assert line.day_at(line.x_of(day)) == pytest.approx(day, abs=a_few_units)
    for scan in (times[0], times[-1]):
        assert line.day_at(line.x_of(scan)) == scan


def test_a_click_near_a_stroke_means_the_scan_that_was_left_out() -> None:
    line = Line(50.0, 550.0, 400.0, (0.0, 2.0), (1.3,))
    assert line.day_at(line.x_of(1.3) + 3.0) == 1.3


@settings(max_examples=10, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.tuples(st.floats(800, 1600), st.floats(480, 1000)))
def test_controls_lie_apart_inside_the_window(
    context: moderngl.Context, size: tuple[float, float]
) -> None:
    with opened(context, small_clip(), size=size) as desk:
        places = [place for name, place in desk.places.items() if name != "plant"]
        assert len(places) >= 6
        for left, top, right, bottom in places:
            assert 0.0 <= left < right <= size[0] + 1.0
            assert 0.0 <= top < bottom <= size[1]
        for one, other in combinations(places, 2):
            apart = one[2] <= other[0] + 9.0 or other[2] <= one[0] + 9.0
            assert apart or one[3] <= other[1] or other[3] <= one[1]


def close(seen: np.ndarray, wanted: tuple[float, ...]) -> bool:
    return bool(np.abs(seen - np.array([*wanted][:3]) * 255).max() <= 3)


def changed(one: np.ndarray, other: np.ndarray) -> tuple[int, int, int, int]:
    """Left, top, right and bottom of what differs; right and bottom are the first that don't."""
    rows, columns = np.nonzero((one != other).any(axis=2))
    assert len(rows), "nothing differs"
    return columns.min(), rows.min(), columns.max() + 1, rows.max() + 1


def written(pixels: np.ndarray) -> int:
    """How many pixels have the colour of writing."""
    return int((np.abs(pixels - np.array([*DARK.text][:3]) * 255).max(axis=2) < 40).sum())


@pytest.mark.parametrize("scale", [1.0, 1.5, 2.0])
@pytest.mark.parametrize(("ground", "theme"), [("dark", DARK), ("light", LIGHT)])
def test_the_handle_stands_at_the_day_on_every_display(
    context: moderngl.Context, scale: float, ground: str, theme: Any
) -> None:
    clip = small_clip(["day 0", "day 1", "day 2"])
    with opened(context, clip, scale=scale) as desk:
        for day in (0.0, 0.7, 2.0):
            drawn(desk, scene_of(clip, day, ground=ground))
            ring = desk.line.x_of(day) + 6.0  # between the handle's hole and its rim
            assert close(desk.color_at(ring, desk.line.height), theme.accent)
        drawn(desk, scene_of(clip, 0.2, ground=ground))
        ahead = desk.color_at(desk.line.x_of(1.5), desk.line.height)
        assert not close(ahead, theme.accent), "days to come are in another colour"


def test_the_plant_stays_free_until_the_help_opens(context: moderngl.Context) -> None:
    clip = small_clip(["day 0", "day 1"])
    with opened(context, clip) as desk:
        free = (slice(90, round(SIZE[1]) - 150), slice(None))
        plain = replace(scene_of(clip), guides=False, legend=False)
        empty = drawn(desk, plain)[free]
        assert (empty == empty[0, 0]).all()
        helped = drawn(desk, replace(plain, help=True))[free]
        assert (helped != empty[0, 0]).any(axis=2).all()


@pytest.mark.parametrize("size", [(800.0, 480.0), (1280.0, 720.0)])
def test_the_help_fits_every_window(context: moderngl.Context, size: tuple[float, float]) -> None:
    clip = small_clip()
    with opened(context, clip, size=size) as desk:
        desk.scene = replace(desk.scene, help=True)
        desk.draw(6)
        window = imgui.internal.find_window_by_name("help")
        assert window.pos.x >= 0.0
        assert window.pos.y >= 0.0
        assert window.pos.x + window.size.x <= size[0]
        assert window.pos.y + window.size.y <= size[1]


def test_pointing_at_a_button_lights_it_and_tells_what_it_does(context: moderngl.Context) -> None:
    clip = small_clip(["day 0", "day 1", "day 2"])
    with opened(context, clip) as desk:
        still = drawn(desk, scene_of(clip))
        left, top, _, bottom = (round(edge) for edge in desk.places["color"])
        drawn(desk, scene_of(clip), desk.middle("color"))
        time.sleep(0.5)  # a tip waits a moment
        desk.draw(5)
        pointed = desk.pixels()
        button = np.s_[top + 10 : bottom - 10, left + 4]
        assert (pointed[button] > still[button]).all(), "lighter behind its icon"
        assert written(pointed[bottom : bottom + 60]) > written(still[bottom : bottom + 60]) + 50
        assert (drawn(desk, scene_of(clip)) == still).all()


def test_pointing_at_the_timeline_shows_the_date_there(context: moderngl.Context) -> None:
    clip = small_clip(["day 0", "day 1", "day 3"], times=(0.0, 1.0, 3.0))
    with opened(context, clip) as desk:
        still, line = drawn(desk, scene_of(clip)), desk.line
        for day in (1.0, 2.2):
            x = round(line.x_of(day))
            pointed = drawn(desk, scene_of(clip), (x, line.height))
            assert close(desk.color_at(x, line.height - 26.0), DARK.card), "a bubble's foot"
            above = np.s_[: round(line.height) - 60]
            assert (pointed[above] == still[above]).all()
            bubble = np.s_[round(line.height) - 50 : round(line.height) - 30, x - 120 : x + 120]
            assert written(pointed[bubble]) > 50, "the date"


@pytest.mark.parametrize("verdict", [None, "all is well", {"doubts": [{"start": 1e300}]}])
def test_a_doubtful_interval_is_marked_and_named(
    context: moderngl.Context, verdict: object
) -> None:
    clip = small_clip(["day 0", "day 1", "day 3"], times=(0.0, 1.0, 3.0))
    doubt = {"start": 1.0, "end": 3.0, "track": 1, "what": "the leaf tears", "identity": False}
    verdicts = verdict, {"doubts": [doubt]}
    pictures, previews = [], []
    for each in verdicts:
        doubted = replace(clip, provenance={"verdict": each})
        with opened(context, doubted) as desk:
            line = desk.line
            pictures.append(drawn(desk, scene_of(clip)))
            previews.append(drawn(desk, scene_of(clip), (line.x_of(2.0), line.height)))
    beside = np.s_[:, : round(line.right) + 10]  # there a key tells what the stroke means
    left, top, right, bottom = changed(pictures[1][beside], pictures[0][beside])
    assert line.x_of(1.0) < left < right < line.x_of(3.0)
    assert line.height < top < bottom < line.height + 13
    middle = pictures[1][(top + bottom) // 2, round(line.x_of(2.0))]
    assert close(middle.astype(int), DARK.loss)
    above = np.s_[: round(line.height) - 20]
    left, _, right, _ = changed(previews[0][above], previews[1][above])
    assert right - left > 150, "a longer bubble, with what looks wrong"


def test_marks_on_the_timeline_have_a_key(context: moderngl.Context) -> None:
    clip = small_clip(["day 0", "day 1", "day 2"])
    stem, leaf = clip.track_table
    born = replace(clip, track_table=(stem, replace(leaf, born=clip.times[1])))
    pictures = []
    for each in (clip, born):
        with opened(context, each) as desk:
            pictures.append(drawn(desk, scene_of(each)))
            line = desk.line
    right = np.s_[:, round(line.right) + 20 :]
    _, top, _, bottom = changed(*(picture[right] for picture in pictures))
    assert line.height < top < bottom < SIZE[1]


def test_a_notice_stands_on_a_card_in_the_middle(context: moderngl.Context) -> None:
    clip = small_clip(["day 0", "day 1"])
    with opened(context, clip) as desk:
        for covered in (False, True):
            scene, widths = replace(scene_of(clip), help=covered), []
            drawn(desk, scene)
            still = drawn(desk, scene)
            for notice in ("Saved plant.png", "Saved plant.png, and more"):
                noticed = drawn(desk, replace(scene, notice=notice))
                left, top, right, bottom = changed(noticed, still)
                assert (left + right) / 2 == pytest.approx(SIZE[0] / 2, abs=2)
                assert 20 < bottom - top < 32, "one line"
                card = noticed[top + 3 : bottom - 3, left + 3 : right - 3].astype(int)
                assert written(card) > 5 * len(notice)
                widths.append(right - left)
            assert widths[1] > 1.3 * widths[0]


def told(desk: Desk, monkeypatch: pytest.MonkeyPatch, *facts: tuple[str, str]) -> None:
    """What the card of an organ says, measured or not."""
    monkeypatch.setattr(desk.interface.organs, "lines", lambda clip, track, day: facts)
    desk.draw(3)


def test_everything_at_once_is_drawn(
    context: moderngl.Context, monkeypatch: pytest.MonkeyPatch
) -> None:
    clip = small_clip()
    scene = scene_of(clip, 0.5, color_by=ColorMode.HEIGHT, picked=1)
    plain = replace(scene, curve="", legend=False)
    scene = replace(scene, curve="", exporting=ExportProgress("a.mp4", 3, 10))
    with opened(context, clip, scene) as desk:
        told(desk, monkeypatch, ("kind", "leaf"))
        whole = desk.pixels().copy()
        assert (drawn(desk, plain) != whole).any()
        assert (drawn(desk, scene) == whole).all()


def test_text_from_clips_is_only_text(
    context: moderngl.Context, monkeypatch: pytest.MonkeyPatch
) -> None:
    hostile = "%s%n##id###x\x00\x1b[31m\n\t" + "🌱日" + "x" * 100_000
    clip = small_clip([hostile] * 3, leaf=hostile)
    scene = replace(scene_of(clip, 0.5, picked=1, color_by=ColorMode.TRACK), panel=True)
    scene = replace(scene, notice=hostile, exporting=ExportProgress(hostile, 1, 2))
    with opened(context, clip, scene, name=hostile) as desk:
        told(desk, monkeypatch, (hostile, hostile))
        desk.point((450.0, SIZE[1] - 50.0))
        desk.draw(5)


def test_nothing_in_a_text_is_hidden(context: moderngl.Context) -> None:
    with opened(context, small_clip()) as desk:
        desk.gui.begin(SIZE, 1.0, DARK)
        pen = Pen(DARK, desk.gui.bold, SIZE, (0.0, 0.0, 0.0, 0.0))
        assert pen.width("leaf##7", 16.0) > pen.width("leaf", 16.0)
        assert one_line("leaf\nleaf") == "leaf leaf"
        assert one_line("a long name", 7) == "a long…"
        desk.gui.end(desk.framebuffer)


def test_the_picked_organ_s_curve_rises_over_the_timeline(
    context: moderngl.Context, monkeypatch: pytest.MonkeyPatch
) -> None:
    clip, count = small_clip(), len(small_clip().times)
    values = tuple(10.0 * (i + 1) for i in range(count))
    curve = TraitCurve(
        1, "area", " mm²", tuple(clip.times), values, (0.5,) * count, (True,) * count
    )
    scene = replace(scene_of(clip).with_style(picked=1), guides=False)
    with opened(context, clip, scene) as desk:
        monkeypatch.setattr(desk.interface.organs, "curves", lambda track: (curve,))
        plotted = replace(scene, curve="area")
        hidden, shown = drawn(desk, replace(scene, curve="")), drawn(desk, plotted)
        assert (drawn(desk, scene) == hidden).all(), "its length was not measured"
        _, top, _, bottom = changed(shown, hidden)
        assert SIZE[1] / 2 < top < bottom - 70
        seen = np.abs(shown.astype(int) - clip.track_table[1].color).max(axis=2) < 20
        seen[: top + 1] = False
        first, last = (
            np.flatnonzero(seen[:, round(desk.line.x_of(day))]).mean()
            for day in clip.times[:: count - 1]
        )
        assert last < first - 15
        drawn(desk, plotted)
        desk.click("curve")
        assert desk.scene.curve == "angle"
