"""Passes are timed on the GPU, frame by frame."""

from __future__ import annotations

import moderngl
import pytest

from player.gl.timers import profile_table
from player.rendering.renderer import Renderer
from player.view.camera import Camera
from player.view.style import Style
from tests.player.conftest import ClipMaker

SIZE = (320, 240)


@pytest.mark.parametrize(
    ("point_size", "passes"),
    [(0.05, {"points", "fill_holes"}), (1.0, {"splat_depth", "splat_sum", "splat_resolve"})],
)
def test_every_pass_of_a_frame_is_timed(
    context: moderngl.Context, make_clip: ClipMaker, point_size: float, passes: set[str]
) -> None:
    clip = make_clip()
    renderer = Renderer(context, clip)
    framebuffer, camera = context.simple_framebuffer(SIZE), Camera.home(clip, 4 / 3)
    for _ in range(4):
        renderer.draw(framebuffer, 1.0, camera, Style(point_size=point_size), SIZE)
    assert renderer.timers.frames == 2, "the last two may not be done yet"
    assert renderer.gpu_seconds > 0.0
    totals = renderer.timers.totals
    assert passes | {"shadow", "blur", "bilateral", "shade", "picture"} <= set(totals)
    assert all(seconds > 0.0 for seconds in totals.values())
    assert sum(totals.values()) < 60.0
    table = profile_table([renderer.timers])
    assert "all of a frame (2 timed)" in table
    assert all(name in table for name in totals)
    renderer.release()
