"""What is lost of organs that were found without labels."""

from __future__ import annotations

import pytest

from baker import Options, bake
from gclip import Motion
from tests.real.series import EXAMPLE


@pytest.mark.parametrize("decay", ["fall", "remove"])
def test_nothing_falls_of_organs_found_without_labels(tmp_path, decay: str) -> None:
    """What is lost are pieces of leaves that the next scan counts to their leaf.

    The example loses organs where it is baked backwards in time.
    """
    for day, name in enumerate(("2020-03-10.ply", "2020-03-08.ply")):
        (tmp_path / f"day{day}.ply").write_bytes((EXAMPLE / name).read_bytes())
    clip = bake([tmp_path], Options(labels="ignore", decay=decay, workers=2))
    lost = [pair for i in clip.intervals for pair in i.segments if pair.event == "loss"]
    leaving = {g.motion for i in clip.intervals for g in i.groups if g.count} - {Motion.MOVE}
    assert lost
    assert leaving == ({Motion.FADE} if decay == "fall" else {Motion.REMOVE})
