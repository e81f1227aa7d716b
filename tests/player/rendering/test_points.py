"""Dots drawn by OpenGL's points and by the compute shader make the same picture."""

from __future__ import annotations

import re
from typing import Any

import moderngl
import numpy as np
import pytest

import player.rendering.renderer
from baker.interpolation.packing import Movers, pack_interval
from gclip import Clip, Motion, ScanMark, Track
from player.gl.framebuffer import GBuffer
from player.rendering.points import SQUARED_DISTANCES
from player.view.style import Style
from shaders import source
from tests.player.drawn import Picture, camera_at, drawn

SIZE = (161, 119)
COUNT = 30_001  # odd: compute shaders draw points by eights


def dense_clip(precision: str = "auto", colors: bool = False, tracks: int = 2) -> Clip:
    """A waving sheet with a smaller one before it, many movers to stride pixel."""
    random = np.random.default_rng(7)
    behind = random.random(COUNT) < 0.7
    x, z = random.uniform(-20, 20, COUNT), random.uniform(0, 40, COUNT)
    start = np.column_stack([x, 2.0 * np.sin(x / 4.0), z])
    start[~behind] = 0.4 * start[~behind] + [0.0, -10.0, 12.0]
    middle, end = start * [1.1, 1.0, 1.1], start * [1.2, 2.0, 1.0]
    paint = random.integers(0, 256, (2, COUNT, 4)).astype(np.uint8)
    movers = Movers(
        Motion.MOVE,
        (start, middle, end),
        np.where(behind, 0, 1) if tracks == 2 else random.integers(0, tracks, COUNT),
        *(paint if colors else (None, None)),
    )
    return Clip(
        scans=(ScanMark("a", 0.0, "", COUNT), ScanMark("b", 1.0, "", COUNT)),
        intervals=(pack_interval(0.0, 1.0, [movers], spacing=1.0, precision=precision),),
        track_table=tuple(
            Track(i, str(i), ((200, 90, 40), (40, 120, 220))[i % 2]) for i in range(tracks)
        ),
        spacing=0.2,
    )


def picture(
    context: moderngl.Context,
    clip: Clip,
    style: Style | None = None,
    **options: Any,
) -> Picture:
    camera = camera_at(clip, SIZE, -80, 0.1)
    return drawn(context, clip, 0.4, camera, SIZE, style, **options)


@pytest.mark.parametrize(
    "kind",
    [{}, {"precision": "float32"}, {"colors": True}, {"tracks": 1500}, {"tracks": 70_000}],
    ids=["quantised", "float32", "scan colours", "many tracks", "wide tracks"],
)
def test_both_ways_make_the_same_picture(
    compute_context: moderngl.Context, kind: dict[str, Any]
) -> None:
    clip = dense_clip(**kind)
    by_points = picture(compute_context, clip, compute=False)
    computed = picture(compute_context, clip, compute=True)
    assert (by_points.max(axis=2) > 60).sum() > 2000
    # Where two movers are equally near to 1 part in 4 million, either may stay.
    assert (np.abs(by_points - computed).max(axis=2) > 2).mean() < 0.002


def test_the_context_decides_what_draws(compute_context: moderngl.Context) -> None:
    """And no measurement: the same machine draws the same picture, always."""
    clip = dense_clip()
    first, second = (picture(compute_context, clip) for _ in range(2))
    assert (first == second).all()
    assert (first == picture(compute_context, clip, compute=True)).all()


def test_dots_look_like_splats(context: moderngl.Context, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where both can be had, changing from one to the other is hardly seen."""
    clip, style = dense_clip(), Style(floor=False)
    dots = picture(context, clip, style)
    monkeypatch.setattr(player.rendering.renderer, "MAX_RADIUS_PX", 0.0)
    splats = picture(context, clip, style)
    assert (dots != splats).any()
    plant = splats.max(axis=2) > 60
    assert (dots.max(axis=2) > 60).sum() == pytest.approx(plant.sum(), rel=0.05)
    assert np.abs(dots - splats)[plant].mean() < 6


@pytest.mark.parametrize("compute", [False, True])
@pytest.mark.parametrize("stride", [2, 8])
def test_fewer_movers_show_the_same_plant(
    compute_context: moderngl.Context, compute: bool, stride: int
) -> None:
    clip, style = dense_clip(), Style(floor=False)
    whole = picture(compute_context, clip, style, compute=compute)
    some = picture(compute_context, clip, style, compute=compute, stride=stride)
    assert (some != whole).any()
    plant = whole.max(axis=2) > 60
    assert (some.max(axis=2) > 60).sum() == pytest.approx(plant.sum(), rel=0.1)
    assert np.abs(some - whole)[plant].mean() < 12


def test_samples_around_a_point_are_sorted_by_distance() -> None:
    text = source("fill_holes.frag")
    offsets = re.findall(r"ivec2\((-?\d), (-?\d)\)", text.split("NEAREST[21]")[1].split(";")[0])
    found = [int(x) ** 2 + int(y) ** 2 for x, y in offsets]
    assert found == SQUARED_DISTANCES.tolist()
    assert len(set(offsets)) == len(offsets)


@pytest.mark.parametrize("point_size", [0.3, 0.7, 1.0, 1.4])
@pytest.mark.parametrize("zoom", [0.7, 1.0, 1.5])
def test_samples_that_no_splat_reaches_are_left_out(
    context: moderngl.Context, monkeypatch: pytest.MonkeyPatch, point_size: float, zoom: float
) -> None:
    clip, style = dense_clip(), Style(point_size=point_size, floor=False)
    camera, run, reached = camera_at(clip, SIZE, -80, 0.1).zoom(zoom), GBuffer.run, []

    def with_all_samples(self: GBuffer, name: str, *arguments: Any, **values: Any) -> None:
        if name == "fill_holes":
            reached.append(values["REACH"])
            values |= {"REACH": 21, "CORE_REACH": 21}
        run(self, name, *arguments, **values)

    found = drawn(context, clip, 0.4, camera, SIZE, style)
    monkeypatch.setattr(GBuffer, "run", with_all_samples)
    wanted = drawn(context, clip, 0.4, camera, SIZE, style)
    assert reached
    difference = np.abs(found - wanted).max(axis=2)
    assert (difference > 2).mean() < 0.001
