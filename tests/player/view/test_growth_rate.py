"""Growth is told from being carried."""

import numpy as np
import pytest

from baker.interpolation.packing import Movers, pack_interval
from gclip import Clip, Motion, ScanMark, Track
from player.view.colors import Colors
from player.view.style import ColorMap, Style
from traits.growth_rate import growth_rates

GROWTH = Style(color_by="growth", color_map=ColorMap.CIVIDIS)


@pytest.fixture
def clip() -> Clip:
    """Two leaves: one sways by a quarter turn and far away, the other grows by 20 % in two days;
    a third one is born.
    """
    leaf = np.random.default_rng(0).uniform(-1, 1, (900, 3)) * [20.0, 10.0, 0.5]
    turned = leaf @ np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    start = np.concatenate([leaf, leaf, 1e-3 * leaf])
    end = np.concatenate([turned + np.array([90.0, 0.0, 0.0]), 1.2 * leaf, leaf])
    movers = Movers(Motion.MOVE, (start, end), np.repeat([0, 1, 2], 900))
    tracks = tuple(Track(i, f"leaf {i}", (9, 9, 9), born=2.0 * (i == 2)) for i in range(3))
    return Clip(
        scans=tuple(ScanMark(str(day), day) for day in (0.0, 2.0)),
        intervals=(pack_interval(0.0, 2.0, [movers], spacing=1.0),),
        track_table=tracks,
        unit="mm",
    )


def test_a_swaying_leaf_does_not_grow(clip: Clip) -> None:
    (rates,), tracks = growth_rates(clip), np.asarray(clip.intervals[0].tracks)
    assert np.abs(rates[tracks == 0]).max() < 0.5
    assert rates[tracks == 1] == pytest.approx(100 * np.log(1.2) / 2, abs=0.5)
    assert np.isinf(rates[tracks == 2]).all()


def test_growth_has_a_unit_and_the_colors_of_a_map(clip: Clip) -> None:
    scale = Colors(clip).value_range(GROWTH)
    assert scale is not None
    assert (scale.title, scale.ends) == ("growth rate", ("0", "10 % a day"))
    ramp, tracks = scale.colors(), np.asarray(clip.intervals[0].tracks)
    assert tuple(ramp[0]) == (0, 34, 78), "cividis"
    worn = Colors(clip).clip_with_colors(GROWTH).intervals[0].start_colors
    assert worn is not None
    assert np.abs(worn[tracks == 0, :3].astype(int) - ramp[0]).max() < 16
    assert (worn[tracks == 2, :3] == ramp[-1]).all()
