"""Organs' colours are distinct, as many as are asked for, and always the same."""

import numpy as np
import pytest

from baker.interpolation.attributes import organ_colors


@pytest.mark.parametrize("count", [0, 1, 2, 700])
def test_as_many_as_asked_for(count):
    colors = organ_colors(count)
    assert len(colors) == count
    assert all(0 <= channel <= 255 for color in colors for channel in color)
    assert colors == organ_colors(700)[:count]


def test_the_first_dozen_stay_apart():
    colors = np.array(organ_colors(12), float)
    apart = np.linalg.norm(colors[:, None] - colors[None], axis=2)
    assert apart[~np.eye(12, dtype=bool)].min() > 40
