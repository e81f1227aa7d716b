"""Fewer pixels on slow machines, and the same picture."""

from dataclasses import replace

import moderngl
import numpy as np
import pytest

from player.view.choices import Compare
from player.view.split_view import panes_of
from player.window.dynamic_resolution import (
    BUDGET,
    MIN_MOVERS,
    MIN_PIXELS,
    STEP,
    STEPS,
    Detail,
    DynamicResolution,
)
from player.window.viewports import Viewports
from tests.player.desk import scene_of
from tests.player.drawn import window_pixels
from tests.player.shown import small_clip

HUGE = (7680, 4320)
LEAST = STEP**STEPS


def test_a_fast_machine_keeps_every_pixel() -> None:
    pace = DynamicResolution()
    for _ in range(100):
        pace.record_frame(1 / 60)
    assert pace.detail(HUGE) == Detail()


def test_a_slow_machine_draws_less_and_recovers() -> None:
    pace = DynamicResolution()
    for _ in range(100):
        pace.record_frame(3 * BUDGET)
    assert pace.detail(HUGE) == Detail(LEAST)
    for _ in range(100):
        pace.record_frame(0.1 * BUDGET)
    assert pace.detail(HUGE) == Detail()


def test_of_very_many_movers_some_are_left_out_before_pixels_are() -> None:
    pace, seen = DynamicResolution(10 * MIN_MOVERS), [Detail()]
    for _ in range(100):
        pace.record_frame(3 * BUDGET)
        if pace.detail(HUGE) != seen[-1]:
            seen.append(pace.detail(HUGE))
    assert [detail.stride for detail in seen] == [1, 2, 4, 8, 8, 8, 8]
    assert [detail.resolution for detail in seen[:5]] == [1.0] * 4 + [0.8]


def test_a_small_window_is_always_drawn_in_full() -> None:
    pace = DynamicResolution()
    for _ in range(100):
        pace.record_frame(3 * BUDGET)
    assert pace.detail((640, 480)) == Detail()
    assert pace.detail((1280, 720)).resolution ** 2 * 1280 * 720 >= 0.999 * MIN_PIXELS


def test_one_slow_picture_changes_nothing() -> None:
    pace = DynamicResolution()
    for _ in range(20):
        pace.record_frame(3 * BUDGET)
        pace.record_frame(0.7 * BUDGET)
    assert pace.detail(HUGE) == Detail()


@pytest.mark.parametrize("cost", [0.2, 0.5, 1.2, 2.0, 4.0])
def test_the_detail_settles_when_the_cost_follows_the_pixels(cost: float) -> None:
    pace, seen = DynamicResolution(), []
    for _ in range(200):
        pace.record_frame(cost * BUDGET * pace.detail(HUGE).resolution ** 2)
        seen.append(pace.detail(HUGE))
    assert len(set(seen[100:])) == 1


@pytest.mark.parametrize("detail", [0.8, 0.62, LEAST])
@pytest.mark.parametrize("compare", list(Compare))
def test_fewer_pixels_show_the_same_picture_over_the_whole_window(
    context: moderngl.Context, detail: float, compare: Compare
) -> None:
    clip, size = small_clip(), (200, 100)
    scene = replace(scene_of(clip, 1.2), compare=compare)
    panes = panes_of(scene, ["plant"])
    viewports, pictures = Viewports(context, [clip]), []
    for pixels in (1.0, detail):
        viewports.draw(size, panes, scene.style, Detail(pixels), None)
        pictures.append(window_pixels(context, viewports, size))
    apart = np.abs(pictures[0] - pictures[1])
    assert 0.0 < apart.mean() < 4.0
    assert apart[:, :20].mean() < 2.0, "the ground reaches the edges"
    assert context.error == "GL_NO_ERROR"
    viewports.release()
