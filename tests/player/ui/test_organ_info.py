"""What is told about a picked organ is what the plot above the timeline shows."""

import time

import pytest

from player.ui.organ_info import OrganInfo
from tests.player.conftest import ClipMaker


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_values_lie_on_the_plotted_curves(make_clip: ClipMaker, share: float) -> None:
    clip = make_clip()
    info = OrganInfo(clip)
    ends = time.monotonic() + 60.0
    while not info.curves(0) and time.monotonic() < ends:
        time.sleep(0.02)
    area = next(curve for curve in info.curves(0) if curve.trait == "area")
    first, second = area.times[:2]
    told = dict(info.lines(clip, 0, first + share * (second - first)))
    number, unit = told["area now"].removeprefix("about ").split()
    expected = (1 - share) * area.values[0] + share * area.values[1]
    assert float(number) == pytest.approx(expected, rel=1e-3)
    assert unit == "mm²"
    assert told["born"] == "before the first scan"
    while not info.curves(1) and time.monotonic() < ends:
        time.sleep(0.02)
    lost = dict(info.lines(clip, 1, clip.times[-1]))
    assert lost["area now"] == "not there"
    assert (lost["grows from"], lost["lost"]) == ("stem", "day 5")
    info.release()
