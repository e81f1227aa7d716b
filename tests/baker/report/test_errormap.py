"""Errors in colours."""

import numpy as np
import pytest

from baker.report.errormap import Scale, common_scale, histogram
from baker.report.verification import Distances, HoldoutError


@pytest.fixture
def error() -> HoldoutError:
    distances = np.random.default_rng(0).exponential(0.01, 5000)
    way = Distances(float(distances.mean()), float(distances.std()), float(distances.max()))
    return HoldoutError("a", "day 1", 1.0, 5000, way, way, 0.002, np.zeros((5000, 3)), distances)


def test_near_is_blue_and_far_is_red_and_farther_is_as_red():
    near, far, farther = Scale(0.01).colors(np.array([0.0, 0.01, 5.0])).astype(int)
    assert near[2] > 100 + near[0]
    assert far[0] > 100 + far[2]
    assert (far == farther).all()


def test_every_step_of_the_scale_has_its_own_color():
    colors = Scale(1.0).colors(np.linspace(0, 1, 40))
    assert len(np.unique(colors, axis=0)) == 40


def test_the_scale_covers_all_but_the_farthest_few(error):
    scale = common_scale([error])
    assert 0.99 < (error.distances < scale.top).mean() < 1.0


def test_the_legends_bars_count_the_points(error):
    scale = common_scale([error])
    bars = histogram(error, scale)
    shares = np.array([bar.height for bar in bars]) ** 2
    assert shares[0] == 1.0
    below = shares[: len(bars) // 2].sum() / shares.sum()
    assert below == pytest.approx((error.distances < scale.top / 2).mean(), abs=0.01)
