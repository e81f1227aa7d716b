"""Passes are timed on the GPU, frame by frame."""

from __future__ import annotations

import moderngl
import pytest

from player.gl.timers import PassTimers, profile_table
from player.rendering.renderer import Renderer
from player.view.camera import Camera
from player.view.split_view import panes_of
from player.view.style import Style
from player.window.dynamic_resolution import Detail
from player.window.viewports import Viewports
from tests.player.conftest import ClipMaker
from tests.player.desk import scene_of

SIZE = (320, 240)


@pytest.mark.parametrize(
    ("point_size", "passes"),
    [(0.05, {"points", "fill_holes"}), (1.0, {"splat_depth", "splat_sum", "splat_resolve"})],
)
def test_every_pass_of_a_frame_is_timed(
    context: moderngl.Context, make_clip: ClipMaker, point_size: float, passes: set[str]
) -> None:
    clip, timers = make_clip(), PassTimers(context)
    renderer = Renderer(context, clip, timers=timers)
    framebuffer, camera = context.simple_framebuffer(SIZE), Camera.home(clip, 4 / 3)
    for _ in range(4):
        gpu_seconds = timers.finish_frame()
        renderer.draw(framebuffer, 1.0, camera, Style(point_size=point_size), SIZE)
    assert timers.frames == 2, "the last two may not be done yet"
    assert gpu_seconds > 0.0
    totals = timers.totals
    assert passes | {"shadow", "blur", "bilateral", "shade", "picture"} <= set(totals)
    assert all(seconds > 0.0 for seconds in totals.values())
    assert sum(totals.values()) < 60.0
    table = profile_table(timers)
    assert "all of a frame (2 timed)" in table
    assert all(name in table for name in totals)
    renderer.release()


def test_frames_of_a_clip_that_was_replaced_still_count(
    context: moderngl.Context, make_clip: ClipMaker
) -> None:
    clip, timers = make_clip(), PassTimers(context)
    for _ in range(2):
        viewports = Viewports(context, [clip], timers)
        for day in (0.0, 1.0, 2.0):
            panes = panes_of(scene_of(clip, day), ["plant"])
            viewports.draw(SIZE, panes, Style(), Detail(), None)
        viewports.release()
    assert timers.frames == 4
    assert "all of a frame (4 timed)" in profile_table(timers)
