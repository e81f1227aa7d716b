"""What is lost of organs that were found without labels."""

from __future__ import annotations

import numpy as np
import plyfile
import pytest

from baker import Options, bake
from gclip import Motion
from tests.real.series import EXAMPLE


@pytest.mark.parametrize("decay", ["fall", "remove"])
def test_nothing_falls_of_organs_found_without_labels(decay: str) -> None:
    """What is lost are mostly pieces of leaves that the next scan counts to their leaf.

    The example loses leaves where a part of it is cut off.
    """
    vertex = plyfile.PlyData.read(EXAMPLE / "2020-03-10.ply")["vertex"]
    points = np.stack([vertex[axis] for axis in "xyz"], axis=1)
    left = points[points[:, 1] < np.median(points[:, 1]) + 2]
    options = Options(labels="ignore", align="none", decay=decay, workers=2)
    clip = bake([points, left], options, times=[0, 1])
    lost = [pair for i in clip.intervals for pair in i.segments if pair.event == "loss"]
    leaving = {g.motion for i in clip.intervals for g in i.groups if g.count} - {Motion.MOVE}
    assert lost
    assert leaving == ({Motion.FADE} if decay == "fall" else {Motion.REMOVE})
