"""The GPU's plant is the CPU's plant, and its pictures are smooth in time."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import pairwise

import moderngl
import numpy as np
import pytest

import player.gl.framebuffer
import player.rendering.renderer
from baker.interpolation.packing import Movers, pack_interval
from gclip import Clip, Motion
from gclip.evaluate import LITTER_FADE, blend_srgb
from player.gl.context import headless
from player.gl.framebuffer import TILE
from player.rendering.renderer import Renderer
from player.view.style import Style
from tests.player.drawn import camera_at, read_pixels
from tests.player.positions import gpu_positions

SIZE = (160, 120)
PLAIN = Style(floor=False)
LOST_AT = 100  # the column right of which nothing is but what the last scan lacks
DAYS = [0.0, 0.1, 1.0, 1.7, 2.0, 2.2, 2.449, 3.3, 4.99, 5.0]


@contextmanager
def drawing(clip: Clip, supersample: int = 1, pitch: float = 0.1) -> Iterator:
    """A function that draws a picture: (height, width, 3) int."""
    context = headless()
    renderer = Renderer(context, clip, supersample)
    framebuffer = context.simple_framebuffer(SIZE)
    camera = camera_at(clip, SIZE, -90, pitch)

    def draw(day: float, style: Style = PLAIN) -> np.ndarray:
        renderer.draw(framebuffer, day, camera, style, SIZE)
        assert context.error == "GL_NO_ERROR"
        return read_pixels(framebuffer)

    yield draw
    renderer.release()
    context.release()


def cover(picture: np.ndarray) -> int:
    """Pixels that the plant takes up on the dark ground."""
    return int((picture.max(axis=2) > 60).sum())


@pytest.mark.parametrize("lost", [Motion.FALL, Motion.FADE, Motion.REMOVE])
@pytest.mark.parametrize("precision", ["auto", "float32"])
@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("computed", [False, True])
def test_positions_on_the_gpu_are_those_of_the_cpu(
    context: moderngl.Context, make_clip, computed: bool, degree: int, precision: str, lost: Motion
) -> None:
    clip = make_clip(degree=degree, precision=precision, lost=lost)
    assert (clip.intervals[0].box is None) == (precision == "float32")
    size = np.linalg.norm(np.subtract(*clip.bounds))
    for day in DAYS:
        frame = clip.at(day)
        parts = [frame.local] + ([frame.litter.local] if frame.litter else [])
        expected = np.concatenate(parts)
        found = gpu_positions(context, clip, day, computed=computed)
        assert found.shape == expected.shape
        assert np.abs(found - expected).max() < 1e-4 * size


def test_the_same_picture_twice_whatever_was_drawn_between(make_clip) -> None:
    with drawing(make_clip()) as draw:
        style = Style()
        first = draw(2.1, style)
        draw(4.0, Style(ground="light"))
        assert (draw(2.1, style) == first).all()
        assert cover(first) > 500


def test_the_middle_of_an_interval_is_as_dense_as_its_scans(make_clip) -> None:
    with drawing(make_clip()) as draw:
        start, middle, end = (cover(draw(day)) for day in (0.0, 1.0, 1.999))
    assert start < middle < end
    assert middle == pytest.approx((start + end) / 2, rel=0.03)


def test_a_surface_has_no_holes(make_clip) -> None:
    with drawing(make_clip()) as draw:
        for day in (0.0, 1.0, 2.0):
            filled = draw(day).max(axis=2) > 60
            rows, columns = np.nonzero(filled)
            inside = filled[rows.min() + 2 : rows.max() - 1, columns.min() + 2 : columns.max() - 1]
            assert inside.mean() > 0.99


def test_colors_blend_in_linear_light(make_clip) -> None:
    start, end = (230, 40, 10, 255), (20, 60, 220, 255)
    half = blend_srgb(np.array([start], np.uint8), np.array([end], np.uint8), 0.5)[0]
    with drawing(make_clip(colors=(start, end))) as draw:
        blended = draw(1.0, replace(PLAIN, color_by="scan"))
        by_track = draw(1.0, replace(PLAIN, color_by="track"))
    with drawing(make_clip(colors=(half, half))) as draw:
        constant = draw(1.0, replace(PLAIN, color_by="auto"))
    with drawing(make_clip()) as draw:
        palette = draw(1.0, replace(PLAIN, color_by="scan"))
    assert np.abs(blended - constant).max() <= 1
    assert (by_track == palette).all()
    assert np.abs(by_track - blended).max() > 40


def standing_still(clip: Clip, days: float) -> Clip:
    """The clip, and after its end the plant as it is then, for some days more."""
    end = clip.times[-1]
    plant = clip.at(end)
    movers = Movers(Motion.MOVE, (plant.local, plant.local), plant.tracks)
    still = pack_interval(end, end + days, [movers], spacing=clip.spacing)
    scan = replace(clip.scans[-1], time=end + days)
    return replace(clip, scans=(*clip.scans, scan), intervals=(*clip.intervals, still))


@pytest.mark.parametrize(
    ("lost", "start", "end"),
    [(Motion.FADE, 2.0, 5.0), (Motion.FALL, 5.0, 5.0 + 3.0 * LITTER_FADE)],
)
def test_what_is_lost_fades_and_never_pops(
    make_clip, lost: Motion, start: float, end: float
) -> None:
    """It is plain to see at first, gone in the end, and of as many pictures as a film has of an
    interval none differs much from the next.
    """
    clip = standing_still(make_clip(lost=lost), days=3.0)
    with drawing(clip, pitch=0.7) as draw:  # litter lies on the ground
        days = [start, *np.linspace(start + 1e-4, end + 1e-4, 45)]
        pictures = [draw(day)[:, LOST_AT:] for day in days]
        without = draw(7.0)[:, LOST_AT:]
    assert np.abs(pictures[0] - without).max() > 40
    whole = np.abs(pictures[0] - without).mean()
    assert np.abs(pictures[-1] - without).mean() < 0.02 * whole
    steps = [np.abs(one - other).mean() for one, other in pairwise(pictures)]
    assert steps[0] < 0.02 * whole, "at the moment when it begins"
    assert max(steps) < 0.15 * whole


def test_light_ground_is_light_and_dark_is_dark(make_clip) -> None:
    with drawing(make_clip()) as draw:
        for floor in (True, False):
            assert draw(0.0, Style(ground="light", floor=floor))[2, 2].min() > 180
            assert draw(0.0, Style(ground="dark", floor=floor))[2, 2].max() < 60


def test_point_size_and_supersampling(make_clip) -> None:
    with drawing(make_clip()) as draw:
        natural = cover(draw(1.0))
        assert cover(draw(1.0, replace(PLAIN, point_size=3.0))) > 1.05 * natural
    with drawing(make_clip(), supersample=2) as draw:
        assert cover(draw(1.0)) == pytest.approx(natural, rel=0.03)


@pytest.mark.parametrize("point_size", [0.3, 1.0, 4.0])
def test_all_splats_are_in_the_tiles_that_are_drawn(
    context: moderngl.Context,
    make_clip,
    monkeypatch: pytest.MonkeyPatch,
    point_size: float,
) -> None:
    """The picture in tiles is the picture in one tile."""
    clip = make_clip(degree=2)
    usual = camera_at(clip, SIZE, -90, 0.1)
    cameras = {
        "usual": usual,
        "aside": usual.pan(0.4 * usual.distance, 0.3 * usual.distance),
        "far": usual.zoom(0.2),
        "near": usual.zoom(4.0),
        "inside": usual.zoom(50.0),
        "flat": usual.with_orthographic(True).zoom(1.5),
    }
    framebuffer = context.simple_framebuffer(SIZE)
    style, pictures = replace(PLAIN, point_size=point_size), dict[str, list[np.ndarray]]()
    for tile in (TILE, max(SIZE)):
        for module in (player.gl.framebuffer, player.rendering.renderer, player.rendering.splats):
            monkeypatch.setattr(module, "TILE", tile)
        renderer = Renderer(context, clip, 1)
        for name, camera in cameras.items():
            for day in (0.0, 1.5, 2.2):
                renderer.draw(framebuffer, day, camera, style, SIZE)
                pictures.setdefault(f"{name}, day {day}", []).append(read_pixels(framebuffer))
        renderer.release()
    for name, (tiled, whole) in pictures.items():
        np.testing.assert_array_equal(tiled, whole, err_msg=name)
    assert min(cover(tiled) for name, (tiled, _) in pictures.items() if "aside" not in name) > 0
