"""What `kept_share` measures, and that its best yaw is found all round the circle."""

import numpy as np
import pytest

from baker.align.sample import even_sample
from baker.align.yaw import Around, exact_yaw, kept_share, likely_yaws


def test_an_unmoved_plant_keeps_all(days):
    around = Around.stem(even_sample(days[0]).points[:150])
    assert kept_share(around, around, 0.0, 0.5) == pytest.approx(1.0)
    assert kept_share(around, around, 65.0, 0.5) < 0.6


def test_growth_alone_keeps_nearly_all(days):
    near, grown = (even_sample(days[0]).points[:150] * factor for factor in (1.0, 1.15))
    assert kept_share(Around.stem(near), Around.stem(grown), 0.0, 0.5) > 0.95


@pytest.mark.parametrize("yaw", [-170.0, -95.0, 3.0, 88.0, 179.0])
def test_every_yaw_is_found(days, posed, yaw):
    earlier, later = even_sample(days[0]), even_sample(posed(days[1], -yaw, (0, 0, 0)))
    likely = likely_yaws(earlier, later)
    found = exact_yaw(earlier, later, likely[0].yaw)
    assert abs((found.yaw - yaw + 180.0) % 360.0 - 180.0) < 2.0


def test_a_bare_stem_is_not_turned():
    stem = even_sample(np.outer(np.linspace(0.0, 10.0, 200), [0.0, 0.0, 1.0]))
    assert [fit.yaw for fit in likely_yaws(stem, stem)] == [0.0]
    assert exact_yaw(stem, stem, 0.0).yaw == 0.0


def test_a_plant_with_two_equal_sides_is_doubtful(posed):
    rng = np.random.default_rng(0)
    side = np.column_stack(
        [1 + 20 * rng.random(600), rng.normal(0, 2, 600), rng.normal(20, 1, 600)]
    )
    both = even_sample(np.concatenate([side, posed(side, 180.0, (0, 0, 0))]))
    yaws = sorted(abs(fit.yaw) for fit in likely_yaws(both, both))
    assert yaws == [0.0, 180.0]
