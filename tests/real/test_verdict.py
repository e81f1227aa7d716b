"""What bakes of real scans say of themselves."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from baker import Options, bake
from baker.verdict.doubt import MIN_SHARE
from gclip import Clip
from tests.real.series import labelled, present
from traits.doubts import doubts_of


def test_the_example_is_what_its_verdict_says(example: Clip) -> None:
    verdict = example.provenance["verdict"]
    said_right = verdict["line"] in ("The interval looks right.", "All 2 intervals look right.")
    assert said_right == (not verdict["doubts"])


if present("maize_control_plant1"):  # no other series is known to turn a leaf round

    def test_a_leaf_that_turns_round_is_named(series: Callable[[str], Path]) -> None:
        """The paper's choices exchange the base and the tip of the lowest leaf from day 7 to 8."""
        scans = sorted(series("maize_control_plant1").glob("*.txt"))[7:9]
        clip = bake(scans, Options(align="none", paper=True, workers=2))
        found = [doubt.what for doubt in doubts_of(clip) if doubt.start == 7.0]
        assert found == ["the tip and the base of leaf 1 change places"]


@pytest.mark.parametrize("name", labelled("tobacco_control_plant1"))
def test_no_organ_becomes_another_in_silence(series: Callable[[str], Path], name: str) -> None:
    """Of the organs that the verdict judges, with 3 % of a scan's points or more."""
    folder = series(name)
    clip = bake([folder], Options(align="none", labels="ignore", workers=2))
    scans = [np.loadtxt(path) for path in sorted(folder.glob("day*.txt"))]
    doubtful = {doubt.start for doubt in doubts_of(clip)}
    for k, interval in enumerate(clip.intervals):
        matched = [pair.track for pair in interval.segments if pair.event == "match"]
        ends = [clip.at(interval.start), clip.at(np.nextafter(interval.end, interval.start))]
        labels = [
            scan[cKDTree(scan[:, :3]).query(frame.positions)[1], 3]
            for scan, frame in zip(scans[k : k + 2], ends, strict=True)
        ]
        for track in matched:
            first, second = (
                np.unique(own[frame.tracks == track], return_counts=True)
                for own, frame in zip(labels, ends, strict=True)
            )
            pure = all(counts.max() > 0.8 * counts.sum() for _, counts in (first, second))
            share = first[1].sum() / len(ends[0].tracks)
            if (
                pure
                and share >= MIN_SHARE
                and first[0][first[1].argmax()] != second[0][second[1].argmax()]
            ):
                assert interval.start in doubtful
