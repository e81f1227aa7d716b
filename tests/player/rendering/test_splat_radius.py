"""The natural point size follows the surface, not the nearest neighbour."""

import time

import numpy as np
import pytest

from player.rendering.splat_radius import ClosingDistances, closing_distance


def grid(along: float, across: float, noise: float = 0.0, size: float = 40.0) -> np.ndarray:
    x, y = np.meshgrid(np.arange(0, size, along), np.arange(0, size, across))
    flat = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    return flat + np.random.default_rng(1).normal(0, noise, flat.shape)


def test_a_square_grid_nearly_closes_at_half_its_diagonal() -> None:
    assert 0.5 < closing_distance(grid(1.0, 1.0)) <= np.sqrt(0.5)


def test_scan_lines_close_at_the_distance_of_the_lines() -> None:
    fine = closing_distance(grid(0.2, 0.2))
    assert closing_distance(grid(0.2, 1.0)) > 2.5 * fine


@pytest.mark.parametrize("gap", [1.0, 2.0, 4.0])
def test_lines_close_however_dense_the_points_on_them_are(gap: float) -> None:
    """From some density on, the nearest neighbours are all on the same line."""
    points = grid(0.2, gap, noise=0.05)
    assert 0.35 * gap < closing_distance(points) < 0.6 * gap


def test_gaps_between_leaves_are_not_closed() -> None:
    leaf = grid(0.2, 0.2, size=1.0)
    places = np.stack(np.meshgrid(*[np.arange(6) * 3.0] * 3), axis=-1).reshape(-1, 3)
    leaves = np.concatenate([leaf + place for place in places])
    assert closing_distance(leaves) < 1.5 * closing_distance(grid(0.2, 0.2))


def test_size_scales_and_repeats_do_not_count() -> None:
    points = grid(1.0, 1.0, noise=0.2)
    once = closing_distance(points)
    assert closing_distance(3.0 * points) == pytest.approx(3.0 * once)
    assert closing_distance(np.repeat(points, 3, axis=0)) == pytest.approx(once, rel=0.05)


@pytest.mark.parametrize("count", [0, 1, 2, 3])
def test_too_few_points_tell_nothing(count: int) -> None:
    assert closing_distance(np.eye(3)[:count].reshape(-1, 3)) == 0.0


def test_the_distance_is_continuous_in_time(make_clip) -> None:
    clip = make_clip()
    distances, (_, start, end) = ClosingDistances(clip), clip.times
    middle = (distances.at(start) + distances.at(end)) / 2
    assert distances.at((start + end) / 2) == pytest.approx(middle)
    assert distances.at(start - 1e-9) == pytest.approx(distances.at(start))


def test_distances_are_measured_ahead(make_clip) -> None:
    clip = make_clip()
    ahead, asked = ClosingDistances(clip), ClosingDistances(clip)
    ahead.measure_ahead()
    wanted = [asked.at(day) for day in clip.times]
    ends = time.monotonic() + 60.0
    while ahead._at_scan.cache_info().currsize < 3 and time.monotonic() < ends:
        time.sleep(0.001)
    ahead.stop()
    assert [ahead.at(day) for day in clip.times] == wanted
    assert ahead._at_scan.cache_info().misses == 3
