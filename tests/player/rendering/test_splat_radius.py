"""The natural point size follows the surface, not the nearest neighbour."""

import numpy as np
import pytest

from player.rendering.splat_radius import ClosingDistances, closing_distance


def grid(along: float, across: float, noise: float = 0.0) -> np.ndarray:
    x, y = np.meshgrid(np.arange(0, 40, along), np.arange(0, 40, across))
    flat = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    return flat + np.random.default_rng(1).normal(0, noise, flat.shape)


def test_a_square_grid_nearly_closes_at_half_its_diagonal() -> None:
    assert 0.5 < closing_distance(grid(1.0, 1.0)) <= np.sqrt(0.5)


def test_scan_lines_close_at_the_distance_of_the_lines() -> None:
    fine = closing_distance(grid(0.2, 0.2))
    assert closing_distance(grid(0.2, 1.0)) > 2.5 * fine


def test_size_scales_and_repeats_do_not_count() -> None:
    points = grid(1.0, 1.0, noise=0.2)
    once = closing_distance(points)
    assert closing_distance(3.0 * points) == pytest.approx(3.0 * once)
    assert closing_distance(np.repeat(points, 3, axis=0)) == pytest.approx(once, rel=0.05)


@pytest.mark.parametrize("count", [0, 1, 2, 3])
def test_too_few_points_tell_nothing(count: int) -> None:
    assert closing_distance(np.eye(3)[:count].reshape(-1, 3)) == 0.0


def test_the_distance_is_continuous_in_time(make_clip) -> None:
    distances = ClosingDistances(make_clip())
    assert distances.at(0, 1.0) == distances.at(1, 0.0)
    middle = (distances.at(1, 0.0) + distances.at(1, 1.0)) / 2
    assert distances.at(1, 0.5) == pytest.approx(middle)


def test_a_guess_is_near_the_distance(make_clip) -> None:
    for points in (grid(1.0, 1.0, noise=0.2), grid(0.2, 1.0), np.repeat(grid(1, 1), 3, axis=0)):
        assert closing_distance(points, roughly=True) == pytest.approx(
            closing_distance(points), rel=0.15
        )
    distances = ClosingDistances(make_clip())
    guess = distances.at(0, 0.0, wait=False)
    assert not distances.settled(0)
    assert guess == pytest.approx(distances.at(0, 0.0), rel=0.15)
    distances.at(0, 1.0)
    assert distances.settled(0)


def test_measuring_goes_on_in_a_thread(make_clip) -> None:
    distances = ClosingDistances(make_clip())
    distances.measure(0)
    assert distances._thread is not None
    distances._thread.join()
    assert all(distances.settled(index) for index in (0, 1))
