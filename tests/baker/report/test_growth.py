"""The growth curves that the report draws."""

from __future__ import annotations

import numpy as np
import pytest

from baker.report.page import length_ticks
from traits.growth import growth_curves


def test_growth_curves_are_the_organs_lengths_at_the_scans(baked):
    """The stem is 10 long and grows by 2 a day; leaf 1 by the square root of 5."""
    clip, _ = baked
    curves = {clip.track_table[c.track].name: c for c in growth_curves(clip)}
    assert curves["stem"].times == [0.0, 2.0, 4.0]
    assert curves["stem"].lengths == pytest.approx([10, 14, 18], rel=0.03)
    assert curves["leaf 1"].lengths == pytest.approx(5**0.5 * np.array([1, 3, 5]), rel=0.06)
    assert curves["leaf 2"].times == [2.0, 4.0], "it is not there yet at the first scan"


@pytest.mark.parametrize("longest", [0.004, 0.99, 1.0, 37.0, 2600.0])
def test_ticks_are_round_and_few_and_reach_the_longest(longest):
    ticks = length_ticks([longest / 2, longest])
    assert ticks[0] == 0.0
    assert ticks[-2] < longest <= ticks[-1]
    assert 2 <= len(ticks) <= 7
    assert f"{ticks[1]:e}"[0] in "125"
