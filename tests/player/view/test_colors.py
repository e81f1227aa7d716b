"""What colours mean: values on a ramp, hidden organs, highlighted ones; the same both ways."""

from dataclasses import replace

import moderngl
import numpy as np
import pytest

from gclip.evaluate import srgb_to_linear
from player.rendering.renderer import Renderer
from player.view.camera import Camera
from player.view.color_modes import nice_ceil
from player.view.colors import Colors
from player.view.style import ColorMode, Style
from tests.player.conftest import ClipMaker

SIZE = (120, 90)
PLAIN = Style(depth_cue=False, floor=False, shading=0.0)


def drawn(
    context: moderngl.Context,
    clip: object,
    day: float,
    style: Style,
    compute: bool = False,
) -> np.ndarray:
    renderer = Renderer(context, clip, compute=compute)  # type: ignore[arg-type]
    framebuffer = context.simple_framebuffer(SIZE)
    camera = replace(Camera.home(clip, 4 / 3), yaw=-np.pi / 2, pitch=0.0)  # type: ignore[arg-type]
    renderer.draw(framebuffer, day, camera, style, SIZE)
    assert context.error == "GL_NO_ERROR"
    pixels = np.frombuffer(framebuffer.read(components=3), np.uint8)
    renderer.release()
    return pixels.reshape(SIZE[1], SIZE[0], 3)[::-1].astype(int)


@pytest.mark.parametrize("color_by", ["age", "speed", "height"])
@pytest.mark.parametrize("degree", [1, 2, 3])
def test_points_and_compute_shaders_show_the_same_values(
    context: moderngl.Context, make_clip: ClipMaker, color_by: str, degree: int
) -> None:
    clip = make_clip(degree=degree, colors=((200, 0, 0, 255), (0, 0, 200, 255)))
    style = replace(PLAIN, color_by=color_by, point_size=0.3)
    ways = [drawn(context, clip, 1.0, style, compute) for compute in (False, True)]
    assert np.abs(ways[0] - ways[1]).max() <= 2
    scans_own = drawn(context, clip, 1.0, replace(style, color_by="scan"))
    assert np.abs(ways[0] - scans_own).max() > 40


def test_height_goes_up_the_ramp(context: moderngl.Context, make_clip: ClipMaker) -> None:
    clip = make_clip()
    picture = drawn(context, clip, 0.0, replace(PLAIN, color_by="height"))
    column = picture[:, SIZE[0] // 2]
    wall = drawn(context, clip, 0.0, replace(PLAIN, hidden=frozenset((0, 1))))[:, SIZE[0] // 2]
    plant = column[(column != wall).any(axis=1)]
    # The ramp goes from purple to yellow: green rises all the way, but for the blended edges.
    assert (np.diff(plant[3:-3:6, 1][::-1]) >= -4).all()
    assert plant[3, 1] > plant[-4, 1] + 60


def test_the_fastest_colour_is_a_speed_of_the_clip(make_clip: ClipMaker) -> None:
    clip = make_clip()
    scale = Colors(clip).value_range(Style(color_by="speed"))
    assert scale is not None
    speeds = [
        np.linalg.norm(clip.at(day + 1e-3).local - clip.at(day).local, axis=1) / 1e-3
        for day in (1.0, 3.0)
    ]
    # The last interval's right half falls: that is no growth.
    moving = np.concatenate([speeds[0], speeds[1][:800]])
    assert scale.high == pytest.approx(nice_ceil(float(np.quantile(moving, 0.98))), rel=0.35)
    assert scale.unit == "mm a day"


@pytest.mark.parametrize("compute", [False, True])
@pytest.mark.parametrize("point_size", [0.3, 3.0])
def test_hidden_organs_are_not_drawn(
    context: moderngl.Context, make_clip: ClipMaker, compute: bool, point_size: float
) -> None:
    clip = make_clip()
    style = replace(PLAIN, point_size=point_size, floor=True)
    both = drawn(context, clip, 1.0, style, compute)
    nothing = drawn(context, clip, 1.0, replace(style, hidden=frozenset((0, 1))), compute)
    left = drawn(context, clip, 1.0, replace(style, hidden=frozenset((1,))), compute)
    alone = drawn(context, clip, 1.0, replace(style, isolated=0), compute)
    middle = SIZE[0] // 2
    assert (left == alone).all()
    assert np.abs(left[:, : middle - 20] - both[:, : middle - 20]).mean() < 8
    assert np.abs(left[20:60, middle + 12 :] - nothing[20:60, middle + 12 :]).max() < 12
    assert np.abs(both - left).max() > 60


@pytest.mark.parametrize("color_by", ["scan", "track", "height"])
def test_others_stand_back_behind_a_picked_organ(
    context: moderngl.Context, make_clip: ClipMaker, color_by: str
) -> None:
    clip = make_clip(colors=((200, 60, 60, 255), (200, 60, 60, 255)))
    style = replace(PLAIN, color_by=color_by)
    plain, picked = (drawn(context, clip, 0.0, replace(style, picked=p)) for p in (None, 0))
    middle = SIZE[0] // 2
    saturation = lambda part: np.ptp(part[20:70], axis=2).mean()  # noqa: E731
    assert saturation(picked[:, middle + 12 :]) < 0.5 * saturation(plain[:, middle + 12 :])
    assert np.abs(picked[:, : middle - 12] - plain[:, : middle - 12]).max() < 12


def test_age_counts_from_birth(make_clip: ClipMaker) -> None:
    clip = make_clip()
    young = replace(clip.track_table[1], born=2.0)
    clip = replace(clip, track_table=(clip.track_table[0], young))
    style = Style(color_by="age")
    scale = Colors(clip).value_range(style)
    assert scale is not None
    palette = Colors(clip).palette(4.5, style)
    ramp = srgb_to_linear(scale.colors() / 255.0)
    assert palette[0, :3] == pytest.approx(ramp[round(255 * 4.5 / 5.0)], abs=1e-6)
    assert palette[1, :3] == pytest.approx(ramp[round(255 * 2.5 / 5.0)], abs=1e-6)


def test_what_a_style_comes_to(make_clip: ClipMaker) -> None:
    bare, colored = make_clip(), make_clip(colors=((0, 0, 0, 255), (9, 9, 9, 255)))
    assert Style().color_mode(bare) == "track"
    assert Style().color_mode(colored) == "scan"
    assert Style(color_by="scan").color_mode(bare) == "track"
    assert Colors(bare).value_range(Style(color_by="track")) is None


@pytest.mark.parametrize(
    ("value", "wanted"), [(0.037, 0.04), (1.0, 1.0), (7.0, 8.0), (95.0, 100.0)]
)
def test_round_numbers(value: float, wanted: float) -> None:
    assert nice_ceil(value) == pytest.approx(wanted)


def test_a_newborn_organ_s_colour_changes_from_day_to_day(
    context: moderngl.Context, make_clip: ClipMaker
) -> None:
    """Whatever the renderer has drawn before."""
    clip = make_clip()
    stem, leaf = clip.track_table
    clip = replace(clip, track_table=(stem, replace(leaf, parent=0, born=clip.times[1])))
    renderer, framebuffer = Renderer(context, clip), context.simple_framebuffer(SIZE)
    camera, style = Camera.home(clip, 4 / 3), replace(PLAIN, color_by="track")
    for day in (0.2, 1.8):
        renderer.draw(framebuffer, day, camera, style, SIZE)
    again = np.frombuffer(framebuffer.read(components=3), np.uint8)
    fresh = Renderer(context, clip)
    fresh.draw(framebuffer, 1.8, camera, style, SIZE)
    assert (again == np.frombuffer(framebuffer.read(components=3), np.uint8)).all()
    for one in (renderer, fresh):
        one.release()


@pytest.mark.parametrize("mode", ColorMode)
def test_each_mode_says_where_its_values_are_known(make_clip: ClipMaker, mode: ColorMode) -> None:
    quantity, clip = mode.quantity, make_clip()
    places = [quantity.per_mover, quantity.per_organ, bool(quantity.glsl)]
    assert places.count(True) == bool(quantity.colormap)
    if quantity.colormap and not quantity.why_unavailable(clip):
        scale = quantity.scale(clip, "")
        given = [len(scale.movers) > 0, len(scale.organs(1.0)) > 0, bool(scale.uniforms)]
        assert given == places
        assert scale.low < scale.high
