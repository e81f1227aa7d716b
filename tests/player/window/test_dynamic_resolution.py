"""Fewer pixels on slow machines, and the same picture."""

import moderngl
import numpy as np
import pytest

from player.window.dynamic_resolution import BUDGET, FEWEST, LEVELS, PLENTY, Detail, Enlarger, Pace

HUGE = (7680, 4320)


def test_a_fast_machine_keeps_every_pixel() -> None:
    pace = Pace()
    for _ in range(100):
        pace.took(1 / 60)
    assert pace.detail(HUGE) == Detail()


def test_a_slow_machine_draws_less_and_recovers() -> None:
    pace = Pace()
    for _ in range(100):
        pace.took(3 * BUDGET)
    assert pace.detail(HUGE) == Detail(LEVELS[-1])
    for _ in range(100):
        pace.took(0.1 * BUDGET)
    assert pace.detail(HUGE) == Detail()


def test_of_very_many_movers_some_are_left_out_before_pixels_are() -> None:
    pace, seen = Pace(10 * FEWEST), [Detail()]
    for _ in range(100):
        pace.took(3 * BUDGET)
        if pace.detail(HUGE) != seen[-1]:
            seen.append(pace.detail(HUGE))
    assert [detail.every for detail in seen] == [1, 2, 4, 8, 8, 8, 8]
    assert [detail.pixels for detail in seen] == [1.0] * 4 + list(LEVELS[1:])


def test_a_small_window_is_always_drawn_in_full() -> None:
    pace = Pace()
    for _ in range(100):
        pace.took(3 * BUDGET)
    assert pace.detail((640, 480)) == Detail()
    assert pace.detail((1280, 720)).pixels ** 2 * 1280 * 720 >= 0.999 * PLENTY


def test_one_slow_picture_changes_nothing() -> None:
    pace = Pace()
    for _ in range(20):
        pace.took(3 * BUDGET)
        pace.took(0.7 * BUDGET)
    assert pace.detail(HUGE) == Detail()


@pytest.mark.parametrize("cost", [0.2, 0.5, 1.2, 2.0, 4.0])
def test_the_detail_settles_when_the_cost_follows_the_pixels(cost: float) -> None:
    pace, seen = Pace(), []
    for _ in range(200):
        pace.took(cost * BUDGET * pace.detail(HUGE).pixels ** 2)
        seen.append(pace.detail(HUGE))
    assert len(set(seen[100:])) == 1


@pytest.mark.parametrize("detail", LEVELS)
def test_the_enlarged_picture_covers_the_whole_window(
    context: moderngl.Context, detail: float
) -> None:
    enlarger, window = Enlarger(context), context.simple_framebuffer((200, 100), 3)
    sizes = []

    def paint(framebuffer: moderngl.Framebuffer, size: tuple[int, int]) -> None:
        sizes.append(size)
        framebuffer.use()
        framebuffer.clear(0.2, 0.4, 0.6)
        # The left half in another colour: it must stay the left half.
        framebuffer.clear(0.8, 0.4, 0.6, viewport=(0, 0, size[0] // 2, size[1]))

    enlarger.draw(window, (200, 100), detail, paint)
    pixels = np.frombuffer(window.read(components=3, alignment=1), np.uint8).reshape(100, 200, 3)
    assert sizes == [(round(200 * detail), round(100 * detail))]
    assert (pixels[:, :97] == (204, 102, 153)).all()
    assert (pixels[:, 103:] == (51, 102, 153)).all()
    assert context.error == "GL_NO_ERROR"
    enlarger.release()
