"""Errors in colours."""

import numpy as np
import pytest

from baker.report.errormap import ErrorScale
from baker.report.verification import Distances, HoldoutError


@pytest.fixture
def error() -> HoldoutError:
    distances = np.random.default_rng(0).exponential(0.01, 5000)
    both = Distances.of(distances)
    return HoldoutError("a", "day 1", 1.0, 5000, both, both, 0.002, np.zeros((5000, 3)), distances)


def test_small_is_blue_and_large_is_red_and_larger_is_as_red():
    small, large, larger = ErrorScale(0.01).colors(np.array([0.0, 0.01, 5.0])).astype(int)
    assert small[2] > 100 + small[0]
    assert large[0] > 100 + large[2]
    assert (large == larger).all()


def test_every_step_of_the_scale_has_its_own_color():
    colors = ErrorScale(1.0).colors(np.linspace(0, 1, 40))
    assert len(np.unique(colors, axis=0)) == 40


def test_the_scale_covers_all_but_the_largest_few(error):
    scale = ErrorScale.of([error])
    assert 0.99 < (error.distances < scale.top).mean() < 1.0


def test_the_legend_goes_from_blue_to_red(error):
    legend = ErrorScale.of([error]).legend
    assert len(set(legend)) == len(legend)
    red, blue = (int(legend[0][k : k + 2], 16) for k in (1, 5))
    assert blue > red
    red, blue = (int(legend[-1][k : k + 2], 16) for k in (1, 5))
    assert red > blue
