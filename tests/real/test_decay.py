"""What is lost of organs that were found without labels."""

from __future__ import annotations

import pytest

from baker import Options, bake
from gclip import Motion
from tests.real.series import EXAMPLE, SHARED, present

LATER_FIRST = [EXAMPLE / "2020-03-10.ply", EXAMPLE / "2020-03-08.ply"]
TOMATOES = [LATER_FIRST, *([SHARED / n] for n in present("unaligned/tomato2_control_plant3"))]


@pytest.mark.parametrize("decay", ["fall", "remove"])
@pytest.mark.parametrize("scans", TOMATOES, ids=("backwards", "unaligned")[: len(TOMATOES)])
def test_nothing_falls_of_organs_found_without_labels(tmp_path, scans, decay: str) -> None:
    """What is lost are pieces of leaves that the next scan counts to their leaf.

    The example loses organs where it is baked backwards in time.
    """
    if len(scans) > 1:
        copies = [tmp_path / f"day{number}.ply" for number in range(len(scans))]
        for scan, copy in zip(scans, copies, strict=True):
            copy.write_bytes(scan.read_bytes())
        scans = copies
    clip = bake(scans, Options(labels="ignore", decay=decay, workers=2))
    lost = [pair for i in clip.intervals for pair in i.segments if pair.event == "loss"]
    leaving = {g.motion for i in clip.intervals for g in i.groups if g.count} - {Motion.MOVE}
    assert lost
    assert leaving == ({Motion.FADE} if decay == "fall" else {Motion.REMOVE})
