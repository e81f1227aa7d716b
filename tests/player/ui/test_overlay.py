"""What lies over the plant: where it stands (no graphics) and that it is drawn (EGL)."""

from dataclasses import replace
from itertools import combinations, pairwise

import moderngl
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gclip import Clip
from player.ui.canvas import BOLD, Canvas
from player.ui.layout import TIMELINE, Layout, arrange
from player.ui.overlay import Overlay
from player.ui.theme import DARK, LIGHT
from player.view.camera import Camera
from player.view.playback import Timeline
from player.view.state import Scene
from player.view.style import Style
from tests.player.shown import small_clip

SIZE = (900.0, 500.0)
GROUND = (30, 60, 90)

TIMES = st.lists(st.integers(0, 5000), min_size=2, max_size=60, unique=True).map(sorted)
SIZES = st.tuples(st.floats(320, 4000), st.floats(240, 2000))


def laid_out(size: tuple[float, float], times: list[int], date: str = "2020-03-08") -> Layout:
    dates = [date] * len(times)
    return arrange(size, times, dates, dates, lambda text, height: 0.5 * height * len(text))


@given(SIZES, TIMES)
def test_dates_neither_touch_nor_leave_the_window(
    size: tuple[float, float], times: list[int]
) -> None:
    labels = laid_out(size, times).labels
    assert labels[0].scan == 0
    for label in labels:
        assert label.x - label.width / 2 >= 0
        assert label.x + label.width / 2 <= size[0]
    for left, right in pairwise(labels):
        assert left.x + left.width / 2 < right.x - right.width / 2


@given(SIZES, TIMES)
def test_buttons_lie_apart_inside_the_window(size: tuple[float, float], times: list[int]) -> None:
    layout = laid_out(size, times)
    places = list(layout.buttons.values())
    for place in places:
        assert place.x >= 0
        assert place.x + place.width <= size[0]
        assert place.y >= 0
        assert place.y + place.height <= size[1]
        assert layout.under(*place.middle) != TIMELINE
    for one, other in combinations(places, 2):
        apart = one.x + one.width <= other.x or other.x + other.width <= one.x
        assert apart or one.y + one.height <= other.y or other.y + other.height <= one.y


@given(SIZES, TIMES, st.floats(0, 1))
def test_the_day_under_a_day_s_place_is_that_day(
    size: tuple[float, float], times: list[int], share: float
) -> None:
    layout = laid_out(size, times)
    day = times[0] + share * (times[-1] - times[0])
    a_few_units = 5.0 * (times[-1] - times[0]) / (layout.right - layout.left)
    assert layout.day_at(layout.x_of(day)) == pytest.approx(day, abs=a_few_units)
    assert layout.under(layout.x_of(day), layout.line) == TIMELINE
    for time in (times[0], times[-1]):
        assert layout.day_at(layout.x_of(time)) == time


def test_short_dates_stand_in_where_the_full_ones_do_not_fit() -> None:
    times, dates = [0, 1, 2, 3], ["2020-03-08"] * 4
    measure = lambda text, height: 10.0 * len(text)  # noqa: E731
    wide = arrange((1400.0, 500.0), times, dates, ["03-08"] * 4, measure)
    narrow = arrange((480.0, 500.0), times, dates, ["03-08"] * 4, measure)
    assert [label.text for label in wide.labels] == dates
    assert [label.text for label in narrow.labels] == ["03-08"] * 4


def scene_of(clip: Clip, day: float = 0.0, ground: str = "dark") -> Scene:
    camera = Camera()
    return Scene(Timeline.of(clip.times).at(day), camera, camera, Style(ground=ground), False)


class Sheet:
    """Draws an overlay upon an even ground and gives the pixels, top row first."""

    def __init__(self, context: moderngl.Context, clip: Clip, name: str, scale: float) -> None:
        pixels = (round(SIZE[0] * scale), round(SIZE[1] * scale))
        self.framebuffer = context.simple_framebuffer(pixels, 3)
        self.overlay = Overlay(context, clip, name)
        self.scale = scale
        self.context = context

    def draw(self, scene: Scene, **pointing: object) -> tuple[np.ndarray, Layout]:
        self.framebuffer.clear(*(value / 255 for value in GROUND))
        layout = self.overlay.draw(self.framebuffer, scene, SIZE, self.scale, **pointing)  # type: ignore[arg-type]
        assert self.context.error == "GL_NO_ERROR"
        width, height = self.framebuffer.size
        pixels = np.frombuffer(self.framebuffer.read(components=3, alignment=1), np.uint8)
        return pixels.reshape(height, width, 3)[::-1], layout

    def color_at(self, pixels: np.ndarray, x: float, y: float) -> np.ndarray:
        return pixels[round(y * self.scale), round(x * self.scale)].astype(int)


def close(seen: np.ndarray, wanted: tuple[float, ...]) -> bool:
    return bool(np.abs(seen - np.array(wanted[:3]) * 255).max() <= 3)


@pytest.mark.parametrize("scale", [1.0, 1.5, 2.0])
@pytest.mark.parametrize(("ground", "theme"), [("dark", DARK), ("light", LIGHT)])
def test_the_handle_stands_at_the_day_on_every_display(
    context: moderngl.Context, scale: float, ground: str, theme: object
) -> None:
    clip = small_clip(["day 0", "day 1", "day 2"])
    sheet = Sheet(context, clip, "a clip", scale)
    for day in (0.0, 0.7, 2.0):
        pixels, layout = sheet.draw(scene_of(clip, day, ground))
        ring = layout.x_of(day) + 6.0  # between the handle's hole and its rim
        assert close(sheet.color_at(pixels, ring, layout.line), theme.accent)  # type: ignore[attr-defined]
    # The track ahead of an early day is not in the accent's colour.
    pixels, layout = sheet.draw(scene_of(clip, 0.2, ground))
    assert not close(sheet.color_at(pixels, layout.x_of(1.5), layout.line), theme.accent)  # type: ignore[attr-defined]
    sheet.overlay.release()


def test_the_plant_stays_free_until_the_help_opens(context: moderngl.Context) -> None:
    clip = small_clip(["day 0", "day 1"])
    sheet = Sheet(context, clip, "a clip", 1.0)
    free = (slice(90, 350), slice(None))
    plain = replace(scene_of(clip), guides=False, legend=False)
    pixels, _ = sheet.draw(plain)
    assert (pixels[free] == GROUND).all()
    pixels, _ = sheet.draw(replace(plain, help=True))
    assert (pixels[free] != GROUND).any(axis=2).all()
    sheet.overlay.release()


def changed(one: np.ndarray, other: np.ndarray) -> tuple[int, int, int, int]:
    """Left, top, right and bottom of what differs; right and bottom are the first that don't."""
    rows, columns = np.nonzero((one != other).any(axis=2))
    assert len(rows), "nothing differs"
    return columns.min(), rows.min(), columns.max() + 1, rows.max() + 1


def test_pointing_at_a_button_lights_it_and_tells_what_it_does(context: moderngl.Context) -> None:
    clip = small_clip(["day 0", "day 1", "day 2"])
    sheet = Sheet(context, clip, "a clip", 1.0)
    still, layout = sheet.draw(scene_of(clip))
    place = layout.buttons["color"]
    pointed, _ = sheet.draw(scene_of(clip), cursor=place.middle)
    button = np.s_[round(place.y) + 4 : round(place.y + place.height) - 4, round(place.x) + 2]
    assert (pointed[button] > still[button]).all(), "lighter behind its icon"
    left, top, right, bottom = changed(pointed, still)
    assert top == pytest.approx(place.y, abs=2)
    below = round(place.y + place.height) + 20
    assert below + 8 < bottom < below + 20, "a card with one line, and nothing else"
    assert left < place.x < place.x + place.width < right
    card = pointed[below - 10 : below + 10, left + 4 : right - 4].astype(int)
    assert close(np.median(card.reshape(-1, 3), axis=0), DARK.card)
    assert (np.abs(card - np.array(DARK.text[:3]) * 255).max(axis=2) < 40).sum() > 50, "written"
    again, _ = sheet.draw(scene_of(clip))
    assert (again == still).all()
    sheet.overlay.release()


def test_pointing_at_the_timeline_shows_the_date_there(context: moderngl.Context) -> None:
    clip = small_clip(["day 0", "day 1", "day 3"], times=(0.0, 1.0, 3.0))
    sheet = Sheet(context, clip, "a clip", 1.0)
    still, layout = sheet.draw(scene_of(clip))
    for day in (1.0, 2.2):
        x = round(layout.x_of(day))
        pointed, _ = sheet.draw(scene_of(clip), cursor=(x, layout.line))
        assert close(sheet.color_at(pointed, x, layout.line - 26.0), DARK.card), "a bubble's foot"
        assert (pointed[: round(layout.line) - 60] == still[: round(layout.line) - 60]).all()
        bubble = np.s_[round(layout.line) - 50 : round(layout.line) - 30, x - 120 : x + 120]
        written = np.abs(pointed[bubble] - np.array(DARK.text[:3]) * 255).max(axis=2) < 40
        assert written.sum() > 50, "the date"
    sheet.overlay.release()


@pytest.mark.parametrize("verdict", [None, "all is well", {"doubts": [{"start": 1e300}]}])
def test_a_doubtful_interval_is_marked_and_named(
    context: moderngl.Context, verdict: object
) -> None:
    clip = small_clip(["day 0", "day 1", "day 3"], times=(0.0, 1.0, 3.0))
    doubt = {"start": 1.0, "end": 3.0, "track": 1, "what": "the leaf tears", "identity": False}
    verdicts = verdict, {"doubts": [doubt]}
    clips = [replace(clip, provenance={"verdict": each}) for each in verdicts]
    plain, sheet = (Sheet(context, each, "a clip", 1.0) for each in clips)
    still, layout = plain.draw(scene_of(clip))
    marked, _ = sheet.draw(scene_of(clip))
    left, top, right, bottom = changed(marked, still)
    assert layout.x_of(1.0) < left < right < layout.x_of(3.0)
    assert layout.line < top < bottom < layout.line + 13
    assert close(sheet.color_at(marked, layout.x_of(2.0), (top + bottom) // 2), DARK.loss)
    above = np.s_[: round(layout.line) - 20]
    middle = (layout.x_of(2.0), layout.line)
    shown = [each.draw(scene_of(clip), cursor=middle)[0][above] for each in (plain, sheet)]
    left, _, right, _ = changed(*shown)
    assert right - left > 150, "a longer bubble, with what looks wrong"
    plain.overlay.release()
    sheet.overlay.release()


def test_a_notice_stands_on_a_card_in_the_middle(context: moderngl.Context) -> None:
    clip = small_clip(["day 0", "day 1"])
    sheet = Sheet(context, clip, "a clip", 1.0)
    still, _ = sheet.draw(scene_of(clip))
    widths = []
    for notice in ("Saved plant.png", "Saved plant.png, and more"):
        noticed, _ = sheet.draw(replace(scene_of(clip), notice=notice))
        left, top, right, bottom = changed(noticed, still)
        assert (left + right) / 2 == pytest.approx(SIZE[0] / 2, abs=2)
        assert 20 < bottom - top < 30, "one line"
        card = noticed[top + 3 : bottom - 3, left + 3 : right - 3].astype(int)
        assert close(np.median(card.reshape(-1, 3), axis=0), DARK.card)
        written = np.abs(card - np.array(DARK.text[:3]) * 255).max(axis=2) < 40
        assert written.sum() > 5 * len(notice)
        widths.append(right - left)
    assert widths[1] > 1.3 * widths[0]
    sheet.overlay.release()


def test_text_from_clips_is_only_text(context: moderngl.Context) -> None:
    hostile = "%s%n##id###x\x00\x1b[31m\n\t" + "🌱日" + "x" * 100_000
    clip = small_clip([hostile] * 3, leaf=hostile)
    sheet = Sheet(context, clip, hostile, 1.0)
    sheet.draw(scene_of(clip, 0.5))
    sheet.draw(scene_of(clip, 0.5), cursor=(450.0, SIZE[1] - 50.0))
    sheet.overlay.release()


def test_nothing_in_a_text_is_hidden(context: moderngl.Context) -> None:
    canvas = Canvas(context)
    canvas.begin(SIZE, 1.0)
    assert canvas.width("leaf##7", 16.0) > canvas.width("leaf", 16.0)
    assert canvas.width("leaf\nleaf", 16.0) > canvas.width("leaf", 16.0)
    assert canvas.fitted("a long name", 16.0, 40.0).endswith("…")
    assert canvas.width(canvas.fitted("a long name", 16.0, 40.0), 16.0) <= 40.0
    assert canvas.fitted("leaf", 16.0, 400.0, BOLD) == "leaf"
    canvas.finish(context.simple_framebuffer((900, 500), 3))
    canvas.release()
