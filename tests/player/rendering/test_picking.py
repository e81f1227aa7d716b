"""Clicks find the organ that is seen."""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np

from player.rendering.renderer import Renderer
from player.view.camera import Camera
from player.view.style import Style
from tests.player.conftest import ClipMaker

SIZE = (800.0, 600.0)


def test_a_click_finds_the_organ_that_is_seen(
    context: moderngl.Context, make_clip: ClipMaker
) -> None:
    clip = make_clip()
    renderer = Renderer(context, clip)
    camera = replace(Camera.home(clip, 4 / 3), yaw=-np.pi / 2, pitch=0.0)

    def at(x: float, y: float, **style: object) -> int | None:
        return renderer.organ_at(0.0, camera, Style(**style), (x, y), SIZE)  # type: ignore[arg-type]

    assert at(330.0, 300.0) == 0
    assert at(470.0, 300.0) == 1
    assert at(10.0, 10.0) is None
    assert at(470.0, 300.0, hidden=frozenset((1,))) is None
    assert at(470.0, 300.0, isolated=0) is None
    # From behind, right is left.
    camera = camera.orbit(np.pi, 0.0)
    assert at(330.0, 300.0) == 1
    camera = camera.with_orthographic(True)
    assert at(330.0, 300.0) == 1
    renderer.release()


def test_what_lies_in_front_is_picked(context: moderngl.Context, make_clip: ClipMaker) -> None:
    """From the side, the sheet's two halves lie one behind the other."""
    clip = make_clip()
    renderer = Renderer(context, clip)
    for yaw, front in ((0.0, 1), (np.pi, 0)):
        home = Camera.home(clip, 4 / 3)
        camera = replace(home, target=(0.0, 0.0, 20.0), yaw=yaw, pitch=0.0)
        assert renderer.organ_at(0.0, camera, Style(), (400.0, 300.0), SIZE) == front
    renderer.release()
