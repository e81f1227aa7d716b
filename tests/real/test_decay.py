"""What is lost of organs that were found without labels."""

from __future__ import annotations

import pytest

from baker import Options, bake
from gclip import Motion


@pytest.mark.parametrize("decay", ["fall", "remove"])
def test_nothing_falls_of_organs_found_without_labels(shared_data, decay: str) -> None:
    """What is lost are pieces of leaves that the next scan counts to their leaf."""
    folder = shared_data / "unaligned" / "tomato2_control_plant3"
    options = Options(labels="ignore", decay=decay, workers=2)
    clip = bake([folder], options)
    lost = [pair for i in clip.intervals for pair in i.segments if pair.event == "loss"]
    leaving = {g.motion for i in clip.intervals for g in i.groups if g.count} - {Motion.MOVE}
    assert lost
    assert leaving == ({Motion.FADE} if decay == "fall" else {Motion.REMOVE})
